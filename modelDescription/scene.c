#include "scene.h"

#include <math.h>
#include <stdio.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "scene/formulas.h"
#include "scene/connections.h"
#include "scene/packed_mesh.h"
#include "scene/surfaces.h"
#include "xml_output.h"

/* Writes ten digits, which are the same on all platforms. */
static void write_rounded(xmlTextWriterPtr writer, const char *name, double value) {
  char text[32];
  snprintf(text, sizeof text, "%.10g", fabs(value) < 1e-12 ? 0.0 : value);
  write_attribute(writer, name, text);
}

static void write_formula(xmlTextWriterPtr writer, const struct Graph *graph, const char *name, Node node) {
  if (node == ZERO) return;
  write_attribute(writer, name, expression_text(graph, node));
}

static void write_frame_of(xmlTextWriterPtr writer, const struct Model *model, size_t frame) {
  if (frame != BASE_FRAME) write_attribute(writer, "in", model->mechanism.frames[frame].name);
}

static void write_frames(xmlTextWriterPtr writer, const struct Model *model) {
  for (size_t i = BASE_FRAME + 1; i < model->mechanism.frame_count; i++) {
    const struct ReferenceFrame *frame = &model->mechanism.frames[i];
    if (frame->is_of_body) continue; /* drawn as a body */
    xmlTextWriterStartElement(writer, BAD_CAST "frame");
    write_attribute(writer, "name", frame->name);
    write_frame_of(writer, model, frame->parent);
    xmlTextWriterEndElement(writer);
  }
}

static bool has_tensor(const struct Body *body) {
  bool has = false;
  for (int i = 0; i < 9; i++) has |= body->tensor.row[i / 3].along[i % 3] != ZERO;
  return has;
}

static void write_tensor(xmlTextWriterPtr writer, const struct Model *model, const struct Body *body) {
  static const char *const names[3][3] = {{"Ixx", "Ixy", "Ixz"}, {"Ixy", "Iyy", "Iyz"}, {"Ixz", "Iyz", "Izz"}};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) write_formula(writer, model->graph, names[i][j], body->tensor.row[i].along[j]);
}

static void write_body(xmlTextWriterPtr writer, const struct Model *model, const struct Body *body) {
  const char *element = body->has_angle || has_tensor(body)            ? "body"
                        : body->is_in_frame && body->mass.node == ZERO ? "point"
                                                                       : "particle";
  xmlTextWriterStartElement(writer, BAD_CAST element);
  write_attribute(writer, "name", body->name);
  write_formula(writer, model->graph, "mass", body->mass.node);
  write_formula(writer, model->graph, "inertia", body->inertia.node);
  if (body->is_in_frame) write_frame_of(writer, model, body->frame);
  write_tensor(writer, model, body);
  xmlTextWriterEndElement(writer);
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

static void write_mesh(xmlTextWriterPtr writer, const struct Model *model, const struct Mesh *mesh) {
  struct PackedMesh packed = pack_mesh(mesh);
  xmlTextWriterStartElement(writer, BAD_CAST "mesh");
  write_attribute(writer, "id", mesh_id(model, mesh));
  for (int i = 0; i < 3; i++) write_rounded(writer, axes[i], packed.least[i]);
  write_rounded(writer, "step", packed.step);
  write_attribute(writer, "points", packed.points);
  write_attribute(writer, "triangles", packed.triangles);
  xmlTextWriterEndElement(writer);
}

/* Writes a shape; without an attribute "in" it belongs to the base. */
static void write_shape(xmlTextWriterPtr writer, const struct Model *model, const struct ContactShape *shape) {
  static const char *const sizes[] = {"sizeX", "sizeY", "sizeZ"}, *const angles[] = {"roll", "pitch", "yaw"};
  const struct Graph *graph = model->graph;
  xmlTextWriterStartElement(writer, BAD_CAST "shape");
  if (shape->particle != NO_PARTICLE) write_attribute(writer, "in", shape->in);
  else write_frame_of(writer, model, shape->frame);
  write_attribute(writer, "type", shape_type_names[shape->type]);
  write_attribute(writer, "axis", axes[shape->axis]);
  for (int i = 0; i < 3; i++) {
    write_formula(writer, graph, axes[i], shape->offset.along[i]);
    write_formula(writer, graph, sizes[i], shape->size.along[i]);
    write_formula(writer, graph, angles[i], shape->angles[i]);
  }
  write_formula(writer, graph, "radius", shape->radius);
  write_formula(writer, graph, "length", shape->length);
  if (shape->mesh != NULL) write_attribute(writer, "mesh", mesh_id(model, shape->mesh));
  if (shape->color != NULL) write_attribute(writer, "color", shape->color);
  xmlTextWriterEndElement(writer);
}

/* Writes the visible shapes, and each mesh before the first shape that uses it. */
static void write_shapes(xmlTextWriterPtr writer, const struct Model *model) {
  const struct Mechanism *mechanism = &model->mechanism;
  for (size_t i = 0; i < mechanism->shape_count; i++) {
    const struct ContactShape *shape = &mechanism->shapes[i];
    if (shape->is_hidden) continue;
    if (shape->mesh != NULL && first_with(mechanism, shape->mesh) == i) write_mesh(writer, model, shape->mesh);
    write_shape(writer, model, shape);
  }
}

static void write_line(xmlTextWriterPtr writer, const struct DrawnLine *line) {
  static const char *const names[2] = {"from", "to"};
  xmlTextWriterStartElement(writer, BAD_CAST "line");
  write_attribute(writer, "kind", line_kind_names[line->kind]);
  for (int end = 0; end < (has_two_ends(line) ? 2 : 1); end++) {
    if (line->ends[end].name != NULL) write_attribute(writer, names[end], line->ends[end].name);
    for (int i = 0; i < 3 && line->ends[end].name == NULL; i++)
      if (line->ends[end].position[i] != ZERO)
        write_attribute(writer, format_text("%s%d", axes[i], end + 1), line->ends[end].formula[i]);
  }
  if (line->radius_formula != NULL) write_attribute(writer, "radius", line->radius_formula);
  if (line->axis != 2) write_attribute(writer, "axis", axes[line->axis]);
  if (line->color != NULL) write_attribute(writer, "color", line->color);
  if (line->is_guessed) write_attribute(writer, "guessed", "true");
  if (line->has_trail) write_attribute(writer, "trail", "true");
  xmlTextWriterEndElement(writer);
}

static void write_gravity(xmlTextWriterPtr writer, const struct Model *model) {
  const Node *gravity = model->mechanism.gravity.along;
  if (gravity[0] == ZERO && gravity[1] == ZERO && gravity[2] == ZERO) return;
  xmlTextWriterStartElement(writer, BAD_CAST "gravity");
  for (int i = 0; i < 3; i++) write_formula(writer, model->graph, axes[i], gravity[i]);
  xmlTextWriterEndElement(writer);
}

static void write_object(xmlTextWriterPtr writer, const char *name, const struct SampledPositions *samples,
                         size_t object) {
  if (samples->objects[object].name != NULL) write_attribute(writer, name, samples->objects[object].name);
}

static char *force_name(const struct SampledPositions *samples, size_t constraint) {
  return constraint_force_name(&samples->model->constraints.items[constraint]);
}

static void write_rod(xmlTextWriterPtr writer, const struct SampledPositions *samples, const struct Rod *rod) {
  xmlTextWriterStartElement(writer, BAD_CAST "rod");
  write_object(writer, "from", samples, rod->from);
  write_object(writer, "to", samples, rod->to);
  if (rod->has_force) {
    write_attribute(writer, "force", force_name(samples, rod->constraint));
    write_rounded(writer, "factor", rod->factor);
  }
  xmlTextWriterEndElement(writer);
}

/* Writes a coordinate by its formula, or as a number if that is NULL. */
static void write_coordinate(xmlTextWriterPtr writer, const char *name, double coordinate, const char *formula) {
  if (formula != NULL) write_attribute(writer, name, formula);
  else write_rounded(writer, name, coordinate);
}

static void write_joint(xmlTextWriterPtr writer, const struct SampledPositions *samples, const struct SceneJoint *joint,
                        char **formulas) {
  xmlTextWriterStartElement(writer, BAD_CAST "joint");
  write_object(writer, "of", samples, joint->of);
  write_coordinate(writer, "x", joint->coordinates[0], formulas[0]);
  write_coordinate(writer, "y", joint->coordinates[1], formulas[1]);
  write_object(writer, "with", samples, joint->with);
  write_coordinate(writer, "withX", joint->coordinates[2], formulas[2]);
  write_coordinate(writer, "withY", joint->coordinates[3], formulas[3]);
  for (size_t i = 0; i < joint->force_count; i++) {
    write_attribute(writer, format_text("force%zu", i + 1), force_name(samples, joint->constraints[i]));
    write_rounded(writer, format_text("x%zu", i + 1), joint->along[i][0]);
    write_rounded(writer, format_text("y%zu", i + 1), joint->along[i][1]);
  }
  xmlTextWriterEndElement(writer);
}

static void write_surface(xmlTextWriterPtr writer, const struct SampledPositions *samples,
                          const struct SceneSurface *surface) {
  static const char *const normals[3] = {"nx", "ny", "nz"};
  xmlTextWriterStartElement(writer, BAD_CAST "surface");
  write_object(writer, "of", samples, surface->object);
  for (int axis = 0; axis < 3; axis++) {
    write_rounded(writer, axes[axis], surface->point[axis]);
    write_rounded(writer, normals[axis], surface->normal[axis]);
  }
  if (surface->is_stop) write_attribute(writer, "stop", "true");
  xmlTextWriterEndElement(writer);
}

static void write_connections(xmlTextWriterPtr writer, const struct Model *model) {
  struct SampledPositions samples = sample_positions(model, false, NULL);
  struct Connections connections = find_connections(&samples);
  char **formulas = joint_formulas(model, &connections);
  struct Surfaces surfaces = find_surfaces(&samples);
  for (size_t i = 0; i < connections.rod_count; i++) write_rod(writer, &samples, &connections.rods[i]);
  for (size_t i = 0; i < connections.joint_count; i++)
    write_joint(writer, &samples, &connections.joints[i], formulas + JOINT_COORDINATES * i);
  for (size_t i = 0; i < surfaces.count; i++) write_surface(writer, &samples, &surfaces.items[i]);
  release_positions(&samples);
}

bool has_scene(const struct Model *model) {
  const struct Mechanism *mechanism = &model->mechanism;
  return mechanism->body_count + mechanism->shape_count + model->drawing.count > 0 ||
         mechanism->frame_count > BASE_FRAME + 1;
}

void scene_write(xmlTextWriterPtr writer, const struct Model *model) {
  xmlTextWriterStartElement(writer, BAD_CAST "scene");
  write_gravity(writer, model);
  write_frames(writer, model);
  for (size_t i = 0; i < model->mechanism.body_count; i++) write_body(writer, model, &model->mechanism.bodies[i]);
  write_shapes(writer, model);
  for (size_t i = 0; i < model->drawing.count; i++) write_line(writer, &model->drawing.lines[i]);
  write_connections(writer, model);
  xmlTextWriterEndElement(writer);
}
