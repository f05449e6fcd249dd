#include "read/shapes/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "names/similar.h"
#include "read/shapes/shape_meshes.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* A dimension of a shape, and the types that have it, as bits. */
struct ShapeDimension {
  const char *name;
  unsigned types, needing; /* types that require it */
};

/* The bit of a type in sets of types. */
#define TYPE(type) (1u << (type))

enum {
  with_radius = TYPE(SHAPE_SPHERE) | TYPE(SHAPE_CYLINDER) | TYPE(SHAPE_CAPSULE),
  with_length = TYPE(SHAPE_CYLINDER) | TYPE(SHAPE_CAPSULE),
  with_sizes = TYPE(SHAPE_BOX) | TYPE(SHAPE_ELLIPSOID),
  without_axis = TYPE(SHAPE_SPHERE) | TYPE(SHAPE_MESH) | with_sizes
};

static const struct ShapeDimension measures[] = {
    {"radius", with_radius, with_radius},         {"length", with_length, with_length},
    {"sizeX", with_sizes, TYPE(SHAPE_ELLIPSOID)}, {"sizeY", with_sizes, TYPE(SHAPE_ELLIPSOID)},
    {"sizeZ", with_sizes, TYPE(SHAPE_ELLIPSOID)},
};
static const char *const of_meshes[] = {"file", "scale"};
enum { MEASURE_COUNT = sizeof measures / sizeof *measures };

static const struct ContactShape *find_shape(const struct Reader *reader, const char *name) {
  const struct Mechanism *mechanism = &reader->model->mechanism;
  for (size_t i = 0; i < mechanism->shape_count; i++)
    if (strcmp(mechanism->shapes[i].name, name) == 0) return &mechanism->shapes[i];
  return NULL;
}

static enum ShapeType type_of(xmlNodePtr node) {
  enum ShapeType type = SHAPE_PLANE;
  for (size_t i = 0; i < SHAPE_TYPES; i++)
    if (attribute_is(node, "type", shape_type_names[i])) type = (enum ShapeType)i;
  return type; /* others are rejected by the schema */
}

static const char *article_of(const struct ContactShape *shape) {
  return shape->type == SHAPE_ELLIPSOID ? "an" : "a";
}

static void check_measures(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shape) {
  bool has_size = false;
  for (int i = 0; i < MEASURE_COUNT; i++) {
    const struct ShapeDimension *measure = &measures[i];
    bool is_given = has_attribute(node, measure->name), is_of_type = (measure->types & TYPE(shape->type)) != 0,
         is_needed = (measure->needing & TYPE(shape->type)) != 0;
    has_size |= is_given;
    if (is_given && !is_of_type)
      report_at(reader, node, "the shape '%s' is %s %s, which has no %s; expected none", shape->name, article_of(shape),
                shape_type_names[shape->type], measure->name);
    if (!is_given && is_needed)
      report_at(reader, node, "the %s '%s' has no %s; expected %s=\"...\" in m", shape_type_names[shape->type],
                shape->name, measure->name, measure->name);
  }
  for (int i = 0; i < 2; i++)
    if (has_attribute(node, of_meshes[i]) && shape->type != SHAPE_MESH)
      report_at(reader, node, "the shape '%s' is %s %s, which has no %s; expected none", shape->name, article_of(shape),
                shape_type_names[shape->type], of_meshes[i]);
  if (has_attribute(node, "stands") && shape->type != SHAPE_CYLINDER)
    report_at(reader, node, "the shape '%s' is %s %s, which takes no stands; expected a cylinder", shape->name,
              article_of(shape), shape_type_names[shape->type]);
  if (shape->type == SHAPE_MESH && !has_attribute(node, "file"))
    report_at(reader, node, "the mesh '%s' has no file; expected file=\"...\" with the path of an STL or OBJ file",
              shape->name);
  if (has_attribute(node, "axis") && (TYPE(shape->type) & without_axis) != 0)
    report_at(reader, node, "the shape '%s' is %s %s, which takes no axis; remove the attribute", shape->name,
              article_of(shape), shape_type_names[shape->type]);
  if (shape->type == SHAPE_BOX && !has_size)
    report_at(reader, node, "the box '%s' has no size; expected sizeX, sizeY and sizeZ in m", shape->name);
}

/* True for the number 0, and without the attribute. Names of other expressions are not known yet. */
static bool is_zero_or_missing(xmlNodePtr node, const char *name) {
  char *text = attribute(node, name), *end;
  return text == NULL || (strtod(text, &end) == 0 && end != text && *end == '\0');
}

static bool is_false(xmlNodePtr node, const char *name) {
  return attribute_is(node, name, "false") || attribute_is(node, name, "0");
}

void declare_shape(struct Reader *reader, xmlNodePtr node) {
  struct Mechanism *mechanism = &reader->model->mechanism;
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  if (find_shape(reader, name) != NULL)
    report_at(reader, node, "a shape named '%s' is already defined; expected another name", name);
  struct ContactShape shape = {
      .name = name, .type = type_of(node), .particle = NO_PARTICLE, .axis = 2, .offset = {{ZERO, ZERO, ZERO}}};
  check_measures(reader, node, &shape);
  if (shape.type == SHAPE_MESH) shape.mesh = mesh_of_shape(reader, node);
  shape.color = attribute(node, "color");
  shape.is_hidden = is_false(node, "drawn");
  shape.stands = !is_false(node, "stands");
  for (int i = 0; i < 3; i++) shape.is_flat[i] = is_zero_or_missing(node, measures[2 + i].name);
  reader->present->number = mechanism->shape_count;
  APPEND(mechanism->shapes, mechanism->shape_count, shape);
}

static Node read_length(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Quantity length = {.node = ZERO};
  if (!expression_attribute(reader, node, name, IN_MASS, &length)) return ZERO;
  require_unit(reader, line_of_attribute(node, name), name, length, unit_of("m"));
  return length.node;
}

/*
 * Sets the minimum of a parameter that is a size, alone or times a positive number, to 0. Importers then know it, and
 * the FMU rejects negative values.
 */
static void require_not_negative(struct Reader *reader, Node size) {
  const struct Graph *graph = reader->model->graph;
  const struct Vertex *vertex = &graph->vertices[size];
  bool is_multiple = vertex->operation == MULTIPLY && graph_is_constant(graph, vertex->left);
  if (is_multiple && graph_value(graph, vertex->left) > 0.0) vertex = &graph->vertices[size = vertex->right];
  if (vertex->operation != SYMBOL || graph_symbol_of(graph, size)->kind != PARAMETER) return;
  struct Variable *parameter = &reader->model->parameters.items[graph_symbol_of(graph, size)->index];
  parameter->minimum = fmax(parameter->minimum, 0.0);
}

/* Reads a size. One or two sides of a box may be 0, but not all three. */
static Node read_size(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shape, const char *name) {
  if (!has_attribute(node, name)) return ZERO;
  Node size = read_length(reader, node, name);
  const char *what = format_text("the %s of the %s '%s'", name, shape_type_names[shape->type], shape->name);
  require_not_negative(reader, size);
  if (shape->type == SHAPE_BOX) expect_not_negative(reader, node, what, size, true);
  else expect_size(reader, node, what, size, true);
  return size;
}

/* Sets the frame or particle of the shape; the base if the element names none. */
static void set_frame(struct Reader *reader, xmlNodePtr node, struct ContactShape *shape) {
  if (!has_attribute(node, "in")) return;
  char *name = reference_attribute(reader, node, "in");
  struct SpatialPoint point;
  bool is_spatial_point = name != NULL && find_spatial_point(reader, name, &point);
  const struct Body *body = name != NULL && !is_spatial_point ? find_body(reader, name) : NULL;
  shape->in = name;
  if (is_spatial_point) {
    shape->frame = point.frame;
    shape->offset = vector_without_displacements(reader, line_of(node), name, point.offset);
  } else if (body != NULL) shape->particle = (size_t)(body - reader->model->mechanism.bodies);
  else if (name != NULL)
    report_at(reader, node, "there is nothing named '%s' for this <shape>; expected a <frame>, <body> or <particle>",
              name);
}

/* Sets the rotation by roll, pitch and yaw as in URDF: about the fixed axes x, y, z in this order. */
static void rotate_shape(struct Reader *reader, xmlNodePtr node, struct ContactShape *shape) {
  static const char *const names[3] = {"roll", "pitch", "yaw"};
  struct Pose pose = pose_of_base();
  for (int i = 2; i >= 0; i--) {
    struct Quantity angle = {.node = ZERO};
    if (!expression_attribute(reader, node, names[i], IN_MASS, &angle)) continue;
    require_unit(reader, line_of_attribute(node, names[i]), names[i], angle, unit_of("rad"));
    shape->angles[i] = angle.node;
    struct Vector axis = {{ZERO, ZERO, ZERO}};
    axis.along[i] = ONE;
    pose_rotate(reader->model->graph, &pose, axis, angle.node, ZERO);
  }
  shape->rotation = pose.rotation;
}

void place_shape(struct Reader *reader, xmlNodePtr node) {
  if (!has_attribute(node, "name")) return;
  struct Graph *graph = reader->model->graph;
  struct ContactShape *shape = &reader->model->mechanism.shapes[reader->present->number];
  set_frame(reader, node, shape);
  rotate_shape(reader, node, shape);
  for (int i = 0; i < 3; i++) {
    if (attribute_is(node, "axis", axes[i])) shape->axis = i;
    shape->offset.along[i] = add(graph, shape->offset.along[i], read_length(reader, node, axes[i]));
    shape->size.along[i] = read_size(reader, node, shape, measures[2 + i].name);
  }
  shape->radius = read_size(reader, node, shape, "radius");
  shape->length = read_size(reader, node, shape, "length");
  if (shape->type == SHAPE_BOX)
    expect_size(reader, node, format_text("the diagonal of the box '%s'", shape->name),
                power_number(graph, vector_dot(graph, shape->size, shape->size), 0.5), true);
}

static void report_missing_shape(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct SimilarName similar = {.wanted = name};
  size_t count = reader->model->mechanism.shape_count;
  const char **names = allocate(count + 1, sizeof *names);
  for (size_t i = 0; i < count; i++) {
    names[i] = reader->model->mechanism.shapes[i].name;
    similar_consider(&similar, names[i]);
  }
  const char *list = count > 0 ? list_of_names(names, count) : "none yet; expected a <shape>";
  if (similar.best != NULL)
    report_at(reader, node, "there is no shape '%s' above this <contact>; did you mean '%s'? The shapes are: %s", name,
              similar.best, list);
  else
    report_at(reader, node, "there is no shape '%s' above this <contact>; expected one of the shapes there: %s", name,
              list);
}

const struct ContactShape *shape_of_attribute(struct Reader *reader, xmlNodePtr node, const char *attribute_name) {
  char *name = reference_attribute(reader, node, attribute_name);
  const struct ContactShape *shape = name != NULL ? find_shape(reader, name) : NULL;
  if (shape != NULL || name == NULL) return shape;
  report_missing_shape(reader, node, name);
  return NULL;
}
