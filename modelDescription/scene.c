#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "scene/formulas.h"
#include "scene/measures.h"
#include "scene/packed_mesh.h"
#include "xml_output.h"

/* Writes formulas, or, with a start scene, numbers. */
struct SceneWriter {
  xmlTextWriterPtr xml;
  const struct Model *model;
  const struct StartScene *start; /* NULL for formulas */
};

/* Returns 0 for rounding errors of lengths, angles and components of directions. */
static double without_rounding(double value) {
  return fabs(value) < 1e-12 ? 0.0 : value;
}

/* Writes ten digits, which are the same on all platforms; for a drawing four. */
static void write_rounded(const struct SceneWriter *writer, const char *name, double value) {
  char text[32];
  snprintf(text, sizeof text, "%.*g", writer->start != NULL ? 4 : 10, without_rounding(value));
  write_attribute(writer->xml, name, text);
}

static void write_formula(const struct SceneWriter *writer, const char *name, Node node) {
  if (node == ZERO) return;
  if (writer->start != NULL) write_rounded(writer, name, writer->start->values[node]);
  else write_attribute(writer->xml, name, expression_text(writer->model->graph, node));
}

/* Writes components as one attribute of a start scene, with four digits for each. */
static void write_components(const struct SceneWriter *writer, const char *name, const double *values, int count) {
  struct TextStream text;
  FILE *file = open_text(&text);
  for (int i = 0; i < count; i++) fprintf(file, "%s%.4g", i > 0 ? " " : "", without_rounding(values[i]));
  write_attribute(writer->xml, name, close_text(&text));
}

static void write_frame_of(const struct SceneWriter *writer, size_t frame) {
  if (frame != BASE_FRAME) write_attribute(writer->xml, "in", writer->model->mechanism.frames[frame].name);
}

/* Writes the position and the orientation of an object of a start scene. */
static void write_pose(const struct SceneWriter *writer, const char *name, size_t frame) {
  if (writer->start == NULL) return;
  const struct SampledPositions *samples = &writer->start->samples;
  const double *values = writer->start->values;
  const struct Matrix *rotation = &writer->model->mechanism.frames[frame].pose.rotation;
  double entries[9];
  for (size_t i = 1; i < samples->object_count; i++) {
    if (strcmp(samples->objects[i].name, name) != 0) continue;
    for (int axis = 0; axis < 3; axis++) write_formula(writer, axes[axis], samples->objects[i].position[axis]);
    if (samples->objects[i].is_planar) write_formula(writer, "angle", samples->objects[i].angle);
  }
  for (int i = 0; i < 9; i++) entries[i] = values[rotation->row[i / 3].along[i % 3]];
  if (frame != BASE_FRAME) write_components(writer, "rotation", entries, 9);
}

static void begin(const struct SceneWriter *writer, const char *element) {
  xmlTextWriterStartElement(writer->xml, BAD_CAST element);
}

static void end(const struct SceneWriter *writer) {
  xmlTextWriterEndElement(writer->xml);
}

static void write_frames(const struct SceneWriter *writer) {
  const struct Mechanism *mechanism = &writer->model->mechanism;
  for (size_t i = BASE_FRAME + 1; i < mechanism->frame_count; i++) {
    if (mechanism->frames[i].is_of_body) continue; /* drawn as a body */
    begin(writer, "frame");
    write_attribute(writer->xml, "name", mechanism->frames[i].name);
    write_frame_of(writer, mechanism->frames[i].parent);
    write_pose(writer, mechanism->frames[i].name, i);
    end(writer);
  }
}

static bool has_tensor(const struct Body *body) {
  bool has = false;
  for (int i = 0; i < 9; i++) has |= body->tensor.row[i / 3].along[i % 3] != ZERO;
  return has;
}

static void write_tensor(const struct SceneWriter *writer, const struct Body *body) {
  static const char *const names[3][3] = {{"Ixx", "Ixy", "Ixz"}, {"Ixy", "Iyy", "Iyz"}, {"Ixz", "Iyz", "Izz"}};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) write_formula(writer, names[i][j], body->tensor.row[i].along[j]);
}

static void write_body(const struct SceneWriter *writer, const struct Body *body) {
  const char *element = body->has_angle || has_tensor(body)            ? "body"
                        : body->is_in_frame && body->mass.node == ZERO ? "point"
                                                                       : "particle";
  begin(writer, element);
  write_attribute(writer->xml, "name", body->name);
  write_formula(writer, "mass", body->mass.node);
  write_formula(writer, "inertia", body->inertia.node);
  if (body->is_in_frame) write_frame_of(writer, body->frame);
  write_tensor(writer, body);
  write_pose(writer, body->name, body->is_in_frame ? body->frame : BASE_FRAME);
  if (writer->start != NULL && body->mass.node != ZERO)
    write_attribute(writer->xml, "label", expression_text(writer->model->graph, body->mass.node));
  end(writer);
}

/* Returns the index of the first visible shape with this mesh. */
static size_t first_with(const struct Mechanism *mechanism, const struct Mesh *mesh) {
  size_t i = 0;
  while (mechanism->shapes[i].mesh != mesh || mechanism->shapes[i].is_hidden) i++;
  return i;
}

static char *mesh_id(const struct Model *model, const struct Mesh *mesh) {
  return format_text("%zu", first_with(&model->mechanism, mesh) + 1);
}

static void write_mesh(const struct SceneWriter *writer, const struct Mesh *mesh) {
  struct PackedMesh packed = pack_mesh(mesh);
  begin(writer, "mesh");
  write_attribute(writer->xml, "id", mesh_id(writer->model, mesh));
  for (int i = 0; i < 3; i++) write_rounded(writer, axes[i], packed.least[i]);
  write_rounded(writer, "step", packed.step);
  write_attribute(writer->xml, "points", packed.points);
  write_attribute(writer->xml, "triangles", packed.triangles);
  end(writer);
}

/* Writes a shape; without an attribute "in" it belongs to the base. */
static void write_shape(const struct SceneWriter *writer, const struct ContactShape *shape) {
  static const char *const sizes[] = {"sizeX", "sizeY", "sizeZ"}, *const angles[] = {"roll", "pitch", "yaw"};
  begin(writer, "shape");
  if (shape->particle != NO_PARTICLE) write_attribute(writer->xml, "in", shape->in);
  else write_frame_of(writer, shape->frame);
  write_attribute(writer->xml, "type", shape_type_names[shape->type]);
  write_attribute(writer->xml, "axis", axes[shape->axis]);
  for (int i = 0; i < 3; i++) {
    write_formula(writer, axes[i], shape->offset.along[i]);
    write_formula(writer, sizes[i], shape->size.along[i]);
    write_formula(writer, angles[i], shape->angles[i]);
  }
  write_formula(writer, "radius", shape->radius);
  write_formula(writer, "length", shape->length);
  if (shape->mesh != NULL) write_attribute(writer->xml, "mesh", mesh_id(writer->model, shape->mesh));
  if (shape->color != NULL) write_attribute(writer->xml, "color", shape->color);
  end(writer);
}

/* Writes the visible shapes, and each mesh before the first shape that uses it; a start scene has no meshes. */
static void write_shapes(const struct SceneWriter *writer) {
  const struct Mechanism *mechanism = &writer->model->mechanism;
  for (size_t i = 0; i < mechanism->shape_count; i++) {
    const struct ContactShape *shape = &mechanism->shapes[i];
    if (shape->is_hidden || (shape->mesh != NULL && writer->start != NULL)) continue;
    if (shape->mesh != NULL && first_with(mechanism, shape->mesh) == i) write_mesh(writer, shape->mesh);
    write_shape(writer, shape);
  }
}

/* Writes the name of the object that is there, or the coordinates. */
static void write_end(const struct SceneWriter *writer, const struct LineEnd *point, int number) {
  if (point->name != NULL) write_attribute(writer->xml, number == 1 ? "from" : "to", point->name);
  for (int i = 0; i < 3 && point->name == NULL; i++) {
    char *name = format_text("%s%d", axes[i], number);
    if (point->position[i] == ZERO) continue;
    if (writer->start != NULL) write_rounded(writer, name, writer->start->line_values[point->position[i]]);
    else write_attribute(writer->xml, name, point->formula[i]);
  }
}

/* length: the parameter that is the length, for a start scene; NULL for none. */
static void write_line(const struct SceneWriter *writer, const struct DrawnLine *line, const char *length) {
  begin(writer, "line");
  write_attribute(writer->xml, "kind", line_kind_names[line->kind]);
  for (int i = 0; i < (has_two_ends(line) ? 2 : 1); i++) write_end(writer, &line->ends[i], i + 1);
  if (line->radius_formula != NULL && writer->start != NULL)
    write_rounded(writer, "radius", writer->start->line_values[line->radius]);
  else if (line->radius_formula != NULL) write_attribute(writer->xml, "radius", line->radius_formula);
  if (line->axis != 2) write_attribute(writer->xml, "axis", axes[line->axis]);
  if (line->color != NULL) write_attribute(writer->xml, "color", line->color);
  if (line->is_guessed) write_attribute(writer->xml, "guessed", "true");
  if (line->has_trail) write_attribute(writer->xml, "trail", "true");
  if (length != NULL) write_attribute(writer->xml, "label", length);
  end(writer);
}

static void write_gravity(const struct SceneWriter *writer) {
  const Node *gravity = writer->model->mechanism.gravity.along;
  if (gravity[0] == ZERO && gravity[1] == ZERO && gravity[2] == ZERO) return;
  begin(writer, "gravity");
  for (int i = 0; i < 3; i++) write_formula(writer, axes[i], gravity[i]);
  end(writer);
}

static void write_object(const struct SceneWriter *writer, const char *name, const struct SampledPositions *samples,
                         size_t object) {
  if (samples->objects[object].name != NULL) write_attribute(writer->xml, name, samples->objects[object].name);
}

static void write_force(const struct SceneWriter *writer, const char *name, size_t constraint) {
  write_attribute(writer->xml, name, constraint_force_name(&writer->model->constraints.items[constraint]));
}

static void write_rod(const struct SceneWriter *writer, const struct SampledPositions *samples, const struct Rod *rod) {
  begin(writer, "rod");
  write_object(writer, "from", samples, rod->from);
  write_object(writer, "to", samples, rod->to);
  if (rod->has_force && writer->start == NULL) {
    write_force(writer, "force", rod->constraint);
    write_rounded(writer, "factor", rod->factor);
  }
  end(writer);
}

/* Writes a coordinate by its formula, or as a number if that is NULL. */
static void write_coordinate(const struct SceneWriter *writer, const char *name, double coordinate,
                             const char *formula) {
  if (formula != NULL) write_attribute(writer->xml, name, formula);
  else write_rounded(writer, name, coordinate);
}

/* formulas: of the coordinates; all are NULL in a start scene. */
static void write_joint(const struct SceneWriter *writer, const struct SampledPositions *samples,
                        const struct SceneJoint *joint, char *const *formulas) {
  begin(writer, "joint");
  write_object(writer, "of", samples, joint->of);
  write_coordinate(writer, "x", joint->coordinates[0], formulas[0]);
  write_coordinate(writer, "y", joint->coordinates[1], formulas[1]);
  write_object(writer, "with", samples, joint->with);
  write_coordinate(writer, "withX", joint->coordinates[2], formulas[2]);
  write_coordinate(writer, "withY", joint->coordinates[3], formulas[3]);
  for (size_t i = 0; i < joint->force_count && writer->start == NULL; i++) {
    write_force(writer, format_text("force%zu", i + 1), joint->constraints[i]);
    write_rounded(writer, format_text("x%zu", i + 1), joint->along[i][0]);
    write_rounded(writer, format_text("y%zu", i + 1), joint->along[i][1]);
  }
  end(writer);
}

static void write_surface(const struct SceneWriter *writer, const struct SampledPositions *samples,
                          const struct SceneSurface *surface) {
  static const char *const normals[3] = {"nx", "ny", "nz"};
  begin(writer, "surface");
  write_object(writer, "of", samples, surface->object);
  for (int axis = 0; axis < 3; axis++) {
    write_rounded(writer, axes[axis], surface->point[axis]);
    write_rounded(writer, normals[axis], surface->normal[axis]);
  }
  if (surface->is_stop) write_attribute(writer->xml, "stop", "true");
  end(writer);
}

static void write_connections(const struct SceneWriter *writer, const struct SampledPositions *samples,
                              const struct Connections *connections, const struct Surfaces *surfaces,
                              char *const *formulas) {
  for (size_t i = 0; i < connections->rod_count; i++) write_rod(writer, samples, &connections->rods[i]);
  for (size_t i = 0; i < connections->joint_count; i++)
    write_joint(writer, samples, &connections->joints[i], formulas + JOINT_COORDINATES * i);
  for (size_t i = 0; i < surfaces->count; i++) write_surface(writer, samples, &surfaces->items[i]);
}

bool has_scene(const struct Model *model) {
  const struct Mechanism *mechanism = &model->mechanism;
  return mechanism->body_count + mechanism->shape_count + model->drawing.count > 0 ||
         mechanism->frame_count > BASE_FRAME + 1;
}

static void write_elements(const struct SceneWriter *writer, const char *const *lengths) {
  const struct Model *model = writer->model;
  write_gravity(writer);
  write_frames(writer);
  for (size_t i = 0; i < model->mechanism.body_count; i++) write_body(writer, &model->mechanism.bodies[i]);
  write_shapes(writer);
  for (size_t i = 0; i < model->drawing.count; i++)
    write_line(writer, &model->drawing.lines[i], lengths != NULL ? lengths[i] : NULL);
}

void scene_write(xmlTextWriterPtr xml, const struct Model *model) {
  const struct SceneWriter writer = {xml, model, NULL};
  struct SampledPositions samples = sample_positions(model, false, NULL);
  struct Connections connections = find_connections(&samples);
  struct Surfaces surfaces = find_surfaces(&samples);
  begin(&writer, "scene");
  write_elements(&writer, NULL);
  write_connections(&writer, &samples, &connections, &surfaces, joint_formulas(model, &connections));
  end(&writer);
  release_positions(&samples);
}

static void write_signals(const struct SceneWriter *writer, const char *element, const struct VariableList *signals) {
  for (size_t i = 0; i < signals->count; i++) {
    begin(writer, element);
    write_attribute(writer->xml, "name", signals->items[i].name);
    end(writer);
  }
}

static void write_mark(const struct SceneWriter *writer, const struct CoordinateMark *mark) {
  begin(writer, "coordinate");
  write_attribute(writer->xml, "name", mark->name);
  write_rounded(writer, "start", mark->start);
  write_components(writer, "from", mark->from, 3);
  write_components(writer, "to", mark->to, 3);
  write_components(writer, mark->is_rotation ? "axis" : "along", mark->along, 3);
  end(writer);
}

void start_scene_write(xmlTextWriterPtr xml, const struct StartScene *scene) {
  const struct SceneWriter writer = {xml, scene->model, scene};
  struct Measures measures = find_measures(scene);
  char **numbers = allocate(JOINT_COORDINATES * scene->connections.joint_count + 1, sizeof *numbers);
  begin(&writer, "scene");
  write_components(&writer, "right", scene->view.right, 3);
  write_components(&writer, "up", scene->view.up, 3);
  if (has_scene(scene->model)) {
    write_elements(&writer, measures.lengths);
    if (!has_described_lines(&scene->model->drawing))
      write_connections(&writer, &scene->samples, &scene->connections, &scene->surfaces, numbers);
    for (size_t i = 0; i < measures.mark_count; i++) write_mark(&writer, &measures.marks[i]);
  } else {
    write_signals(&writer, "input", &scene->model->inputs);
    write_signals(&writer, "output", &scene->model->coordinates);
    write_signals(&writer, "output", &scene->model->outputs);
  }
  end(&writer);
}
