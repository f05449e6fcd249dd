#include "read/space/joints.h"

#include <math.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/constraint_checks.h"
#include "read/context/variables.h"
#include "read/space/rolling.h"
#include "read/space/sides.h"

/*
 * What a joint holds: the place of `to` along the axes of `from`, the directions of its axes, the thread of a screw, and of
 * what rolls the velocity of its lowest point and the height of that.
 */
enum Held { ALONG_X, ALONG_Y, ALONG_Z, ABOUT_X, ABOUT_Y, ABOUT_Z, CROSS, THREAD, SLIP_X, SLIP_Y, HEIGHT, NOTHING };

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
    {"screw", {ALONG_X, ALONG_Y, ABOUT_X, ABOUT_Y, THREAD, NOTHING}},
    {"rolling", {SLIP_X, SLIP_Y, HEIGHT, NOTHING}},
};

/* Names of what is held and of its force or torque, its unit, and the axis of `from` that it is along or about. */
static const struct HeldWords {
  const char *name, *force, *unit;
  char axis;
} words[] = {
    [ALONG_X] = {"x", "forceX", "m", 'x'},       [ALONG_Y] = {"y", "forceY", "m", 'y'},
    [ALONG_Z] = {"z", "forceZ", "m", 'z'},       [ABOUT_X] = {"aboutX", "torqueX", "1", 'x'},
    [ABOUT_Y] = {"aboutY", "torqueY", "1", 'y'}, [ABOUT_Z] = {"aboutZ", "torqueZ", "1", 'z'},
    [CROSS] = {"aboutZ", "torqueZ", "1", 'z'},   [THREAD] = {"thread", "forceZ", "m", 'z'},
    [SLIP_X] = {"slipX", "forceX", "m/s", 'x'},  [SLIP_Y] = {"slipY", "forceY", "m/s", 'y'},
    [HEIGHT] = {"z", "forceZ", "m", 'z'},
};

static bool is_of_force(enum Held held) {
  return words[held].force[0] == 'f';
}

/* What rolls may hold less, where its coordinates hold the rest: the attribute names the axes. */
static bool is_held(xmlNodePtr node, enum Held held) {
  char *axes_held = attribute(node, "holds");
  return axes_held == NULL || strchr(axes_held, words[held].axis) != NULL;
}

static const struct JointType *type_of(xmlNodePtr node) {
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (attribute_is(node, "type", types[i].name)) return &types[i];
  return NULL; /* the schema refuses it */
}

static char *description_of(xmlNodePtr node, const char *joint, enum Held held) {
  const char *from = attribute(node, "from");
  char *what =
      format_text("%s of %s on %s at %s", is_of_force(held) ? "force" : "torque", attribute(node, "to"), from, joint);
  if (held == CROSS) return format_text("%s, about the axis across both of its own", what);
  return format_text("%s, %s the %c axis of %s", what, is_of_force(held) ? "along" : "about", words[held].axis, from);
}

/* An attribute that one type needs, or may have, and no other has. */
static void check_attribute(struct Reader *reader, xmlNodePtr node, const char *name, const char *type,
                            bool is_needed) {
  if (attribute_is(node, "type", type) && is_needed && !has_attribute(node, name))
    report_at(reader, node, "<joint type=\"%s\"> needs the attribute '%s'", type, name);
  else if (!attribute_is(node, "type", type) && has_attribute(node, name))
    report_at(reader, node, "<joint> has the attribute '%s' with type=\"%s\" alone", name, type);
}

void declare_joint(struct Reader *reader, xmlNodePtr node) {
  const struct JointType *type = type_of(node);
  check_attribute(reader, node, "pitch", "screw", true);
  check_attribute(reader, node, "radius", "rolling", true);
  check_attribute(reader, node, "shape", "rolling", false);
  check_attribute(reader, node, "holds", "rolling", false);
  struct Variable joint = common_attributes(reader, node);
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  scope_define(reader->scope, joint.name, word, joint.line);
  reader->present->number = reader->model->constraints.count;
  for (const enum Held *held = type != NULL ? type->held : &(enum Held){NOTHING}; *held != NOTHING; held++) {
    if (!is_held(node, *held)) continue;
    struct Variable constraint =
        variable_create(format_text("%s.%s", joint.name, words[*held].name), description_of(node, joint.name, *held),
                        scope_line(reader->scope, joint.line));
    constraint.force_name = format_text("%s.%s", joint.name, words[*held].force);
    constraint.unit = copy_text(words[*held].unit);
    constraint.dimension = unit_of(constraint.unit);
    append_variable(&reader->model->constraints, constraint);
  }
}

/*
 * Is 0 while it is held. Signs are such that it grows as `to` moves along, or turns about, the axis of `from`, so that the
 * force is what `to` does to `from`.
 */
static Node expression_of(struct Reader *reader, xmlNodePtr node, enum Held held, const struct Side *from,
                          const struct Side *to) {
  enum { X, Y, Z };
  struct Graph *graph = reader->model->graph;
  switch (held) {
  case THREAD: return thread_of(reader, node, from, to);
  case SLIP_X: return slip_of(reader, node, from, to, X);
  case SLIP_Y: return slip_of(reader, node, from, to, Y);
  case HEIGHT: return height_of(reader, node, from, to);
  case ABOUT_X: return negate(graph, product_of_axes(graph, from, Y, to, Z));
  case ABOUT_Y: return product_of_axes(graph, from, X, to, Z);
  case ABOUT_Z: return product_of_axes(graph, from, Y, to, X);
  case CROSS: return negate(graph, product_of_axes(graph, from, X, to, Y));
  default: break;
  }
  return place_along(graph, from, to, (int)held);
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
  if (attribute_is(node, "type", "rolling"))
    return copy_text("expected the axes along which something moves, such as holds=\"x y\"");
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
  if (is_right && attribute_is(node, "type", "rolling")) is_right = can_roll(reader, node, &to);
  if (type == NULL || !is_right) return;
  struct Variable *first = &model->constraints.items[reader->present->number];
  size_t count = 0;
  for (const enum Held *held = type->held; *held != NOTHING; held++)
    if (is_held(node, *held)) first[count++].node = expression_of(reader, node, *held, &from, &to);
  if (reader->diagnostics->errors == 0) check_held(reader, node, first, count);
}
