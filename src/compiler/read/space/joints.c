#include "read/space/joints.h"

#include <math.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/constraint_checks.h"
#include "read/context/variables.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* What a joint holds: the place of `to` along the axes of `from`, and the directions of its axes. */
enum Held { ALONG_X, ALONG_Y, ALONG_Z, ABOUT_X, ABOUT_Y, ABOUT_Z, CROSS, NOTHING };

struct JointType {
  const char *name;
  enum Held held[7]; /* up to the first NOTHING */
};

static const struct JointType types[] = {
    {"pin", {ALONG_X, ALONG_Y, NOTHING}},
    {"spherical", {ALONG_X, ALONG_Y, ALONG_Z, NOTHING}},
    {"universal", {ALONG_X, ALONG_Y, ALONG_Z, CROSS, NOTHING}},
    {"revolute", {ALONG_X, ALONG_Y, ALONG_Z, ABOUT_X, ABOUT_Y, NOTHING}},
    {"cylindrical", {ALONG_X, ALONG_Y, ABOUT_X, ABOUT_Y, NOTHING}},
    {"prismatic", {ALONG_X, ALONG_Y, ABOUT_X, ABOUT_Y, ABOUT_Z, NOTHING}},
    {"planar", {ALONG_Z, ABOUT_X, ABOUT_Y, NOTHING}},
    {"fixed", {ALONG_X, ALONG_Y, ALONG_Z, ABOUT_X, ABOUT_Y, ABOUT_Z, NOTHING}},
};

/* Names of what is held, and of its force or torque. */
static const char *const held_names[] = {"x", "y", "z", "aboutX", "aboutY", "aboutZ", "aboutZ"};
static const char *const force_names[] = {"forceX", "forceY", "forceZ", "torqueX", "torqueY", "torqueZ", "torqueZ"};

static const struct JointType *type_of(xmlNodePtr node) {
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (attribute_is(node, "type", types[i].name)) return &types[i];
  return NULL; /* the schema refuses it */
}

static char *description_of(xmlNodePtr node, const char *joint, enum Held held) {
  const char *from = attribute(node, "from");
  char *what =
      format_text("%s of %s on %s at %s", held < ABOUT_X ? "force" : "torque", attribute(node, "to"), from, joint);
  if (held == CROSS) return format_text("%s, about the axis across both of its own", what);
  return format_text("%s, %s the %c axis of %s", what, held < ABOUT_X ? "along" : "about", "xyzxyz"[held], from);
}

void declare_joint(struct Reader *reader, xmlNodePtr node) {
  const struct JointType *type = type_of(node);
  struct Variable joint = common_attributes(reader, node);
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  scope_define(reader->scope, joint.name, word, joint.line);
  reader->present->number = reader->model->constraints.count;
  for (const enum Held *held = type != NULL ? type->held : &(enum Held){NOTHING}; *held != NOTHING; held++) {
    struct Variable constraint =
        variable_create(format_text("%s.%s", joint.name, held_names[*held]), description_of(node, joint.name, *held),
                        scope_line(reader->scope, joint.line));
    constraint.force_name = format_text("%s.%s", joint.name, force_names[*held]);
    constraint.unit = copy_text(*held < ABOUT_X ? "m" : "1");
    constraint.dimension = unit_of(constraint.unit);
    append_variable(&reader->model->constraints, constraint);
  }
}

/* A side of the joint, where nothing is displaced. */
struct Side {
  struct Vector position; /* along the base's axes */
  struct Matrix rotation;
};

/* What the attribute names: anything in a frame, with the frame's axes, or a particle in the plane, with the base's. */
static bool read_side(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side) {
  long line = xmlGetLineNo(node);
  char *full_name = reference_attribute(reader, node, name);
  if (full_name == NULL) return false;
  if (attribute_is(node, name, "base")) full_name = copy_text("base");
  struct SpatialPoint point;
  const struct Body *body = find_body(reader, full_name);
  const struct ReferenceFrame *frame = &reader->model->mechanism.frames[0];
  if (find_spatial_point(reader, full_name, &point)) {
    frame = &reader->model->mechanism.frames[point.frame];
    side->position = point.position;
  } else if (body != NULL) {
    for (int axis = 0; axis < 3; axis++) side->position.along[axis] = body->displaced[axis];
  } else {
    report_at(
        reader, node,
        "there is nothing named '%s' for this <joint>; expected a <frame>, <body>, <point> or <particle>, or base",
        attribute(node, name));
    return false;
  }
  side->position = vector_without_displacements(reader, line, full_name, side->position);
  side->rotation = matrix_without_displacements(reader, line, full_name, frame->pose.rotation);
  return true;
}

static struct Vector axis_of(const struct Side *side, int axis) {
  return (struct Vector){
      {side->rotation.row[0].along[axis], side->rotation.row[1].along[axis], side->rotation.row[2].along[axis]}};
}

/* The product of an axis of one side and one of the other, 0 where they are perpendicular. */
static Node product(struct Graph *graph, const struct Side *from, int first, const struct Side *to, int second) {
  return vector_dot(graph, axis_of(from, first), axis_of(to, second));
}

/*
 * Is 0 while it is held. Signs are such that it grows as `to` moves along, or turns about, the axis of `from`, so that the
 * force is what `to` does to `from`.
 */
static Node expression_of(struct Graph *graph, enum Held held, const struct Side *from, const struct Side *to) {
  enum { X, Y, Z };
  switch (held) {
  case ABOUT_X: return negate(graph, product(graph, from, Y, to, Z));
  case ABOUT_Y: return product(graph, from, X, to, Z);
  case ABOUT_Z: return product(graph, from, Y, to, X);
  case CROSS: return negate(graph, product(graph, from, X, to, Y));
  default: break;
  }
  struct Vector between =
      vector_add(graph, to->position, vector_scale(graph, graph_constant(graph, -1.0), from->position));
  return vector_dot(graph, axis_of(from, (int)held), between);
}

/* The first of a joint's constraints that nothing moves; NULL where all can be moved. */
static const struct Variable *find_unmoved(const struct Graph *graph, const struct Variable *first, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (graph_is_constant(graph, first[i].node)) return &first[i];
  return NULL;
}

/* Whether expressions know the axes of what an attribute names. */
static bool has_axes(struct Reader *reader, xmlNodePtr node, const char *name) {
  char *full_name = reference_attribute(reader, node, name);
  return full_name != NULL && scope_find(reader->scope, format_text("%s.R11", full_name)) != NULL;
}

/* What to write where places, or some axes, are held without the joint. */
static char *remedy_for(struct Reader *reader, xmlNodePtr node, const struct Variable *first, size_t count) {
  const struct Graph *graph = reader->model->graph;
  const char *from = attribute(node, "from"), *to = attribute(node, "to");
  size_t unmoved = 0;
  for (size_t i = 0; i < count; i++) unmoved += graph_is_constant(graph, first[i].node);
  if (unmoved == count)
    return format_text("nor does anything move the rest of what it holds; expected '%s' and '%s' that move "
                       "against one another",
                       from, to);
  if (attribute_is(node, "type", "universal") && !graph_is_constant(graph, first[count - 1].node) &&
      has_axes(reader, node, "from") && has_axes(reader, node, "to"))
    return format_text("expected <constraint name=\"%s\">%s.R11*%s.R12 + %s.R21*%s.R22 + %s.R31*%s.R32</constraint> "
                       "for shafts whose places are held already",
                       attribute(node, "name"), from, to, from, to, from, to);
  return copy_text("expected a type that leaves it out, such as pin for what moves in a plane, or a <constraint> of "
                   "what moves alone");
}

static void check_held(struct Reader *reader, xmlNodePtr node, const struct Variable *first, size_t count) {
  const struct Graph *graph = reader->model->graph;
  const struct Variable *unmoved = find_unmoved(graph, first, count);
  if (unmoved != NULL)
    report_at(reader, node, "the joint '%s' holds %s, which nothing moves: it is %g at all times; %s",
              attribute(node, "name"), strrchr(unmoved->name, '.') + 1, graph_value(graph, unmoved->node),
              remedy_for(reader, node, first, count));
  for (size_t i = 0; i < count && reader->diagnostics->errors == 0; i++) check_constraint(reader, &first[i]);
}

void read_joint(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  const struct JointType *type = type_of(node);
  struct Side from, to;
  bool is_right = read_side(reader, node, "from", &from);
  is_right &= read_side(reader, node, "to", &to);
  if (type == NULL || !is_right) return;
  struct Variable *first = &model->constraints.items[reader->present->number];
  size_t count = 0;
  for (; type->held[count] != NOTHING; count++)
    first[count].node = expression_of(model->graph, type->held[count], &from, &to);
  check_held(reader, node, first, count);
}
