#include "read/space/joints.h"

#include <math.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/attributes.h"
#include "read/context/constraint_checks.h"
#include "read/context/variables.h"
#include "names/definitions.h"
#include "read/space/rolling.h"
#include "read/space/joint_ends.h"
#include "read/space/vanishing.h"

/*
 * Quantities that a joint constrains: the position of `to` along the axes of `from`, and the directions of its
 * axes. A screw also constrains the thread, rolling the velocity of the lowest point and its height.
 */
enum ConstrainedQuantity {
  ALONG_X,
  ALONG_Y,
  ALONG_Z,
  ABOUT_X,
  ABOUT_Y,
  ABOUT_Z,
  CROSS,
  THREAD,
  SLIP_X,
  SLIP_Y,
  HEIGHT,
  NOTHING
};

struct JointConstraints {
  const char *name;
  enum ConstrainedQuantity quantities[7]; /* ended by NOTHING */
};

static const struct JointConstraints types[] = {
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

/* Per quantity: prefixes of its name and its force's name, its unit, and its axis, whose letter ends the names. */
static const struct QuantityWords {
  const char *name, *force, *unit;
  int axis;
} words[] = {
    [ALONG_X] = {"", "force", "m", 0},       [ALONG_Y] = {"", "force", "m", 1},
    [ALONG_Z] = {"", "force", "m", 2},       [ABOUT_X] = {"about", "torque", "1", 0},
    [ABOUT_Y] = {"about", "torque", "1", 1}, [ABOUT_Z] = {"about", "torque", "1", 2},
    [CROSS] = {"about", "torque", "1", 2},   [THREAD] = {"thread", "force", "m", 2},
    [SLIP_X] = {"slip", "force", "m/s", 0},  [SLIP_Y] = {"slip", "force", "m/s", 1},
    [HEIGHT] = {"", "force", "m", 2},
};

static bool is_of_force(enum ConstrainedQuantity quantity) {
  return words[quantity].force[0] == 'f';
}

/* True if the constraint's force is along or about an axis of `from` only up to a factor, see share_of(). */
static bool has_share(enum ConstrainedQuantity quantity) {
  return !is_of_force(quantity) || quantity == THREAD;
}

static const char *const end_attributes[] = {"from", "to"};

/* Returns the cyclic shift of the axes that moves z, the axis of the types above, to the axis that the joint names. */
static int shift_of(xmlNodePtr node) {
  char *axis = attribute(node, "axis");
  return axis != NULL ? *axis - 'x' + 1 : 0;
}

/* Returns the axis of `from` that the quantity is along or about. */
static int axis_of(xmlNodePtr node, enum ConstrainedQuantity quantity) {
  return (words[quantity].axis + shift_of(node)) % 3;
}

static char *name_of(xmlNodePtr node, enum ConstrainedQuantity quantity) {
  const char *name = words[quantity].name;
  int axis = axis_of(node, quantity);
  if (quantity == THREAD) return copy_text(name);
  return *name == '\0' ? copy_text(axes[axis]) : format_text("%s%c", name, "XYZ"[axis]);
}

static char *force_name_of(const char *joint, xmlNodePtr node, enum ConstrainedQuantity quantity) {
  return format_text("%s.%s%c", joint, words[quantity].force, "XYZ"[axis_of(node, quantity)]);
}

/* Shifts the axes of an end cyclically. */
static void exchange_axes(struct JointEnd *ends, int shift) {
  const struct Matrix given = ends->rotation;
  for (int row = 0; row < 3; row++)
    for (int axis = 0; axis < 3; axis++) ends->rotation.row[row].along[axis] = given.row[row].along[(axis + shift) % 3];
}

/* True unless the attribute `holds` leaves out the axis. Rolling joints may leave axes to their coordinates. */
static bool is_constrained(xmlNodePtr node, enum ConstrainedQuantity quantity) {
  char *named_axes = attribute(node, "holds");
  return named_axes == NULL || strchr(named_axes, *axes[words[quantity].axis]) != NULL;
}

static const struct JointConstraints *type_of(xmlNodePtr node) {
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (attribute_is(node, "type", types[i].name)) return &types[i];
  return NULL; /* rejected by the schema */
}

static char *description_of(xmlNodePtr node, const char *joint, enum ConstrainedQuantity quantity) {
  const char *from = attribute(node, "from");
  char *what = format_text("%s of %s on %s at %s", is_of_force(quantity) ? "force" : "torque", attribute(node, "to"),
                           from, joint);
  return format_text("%s, %s the %s axis of %s", what, is_of_force(quantity) ? "along" : "about",
                     axes[axis_of(node, quantity)], from);
}

/* Reports an axis for a type that has none. */
static void check_axis(struct Reader *reader, xmlNodePtr node) {
  static const char *const with_axis[] = {"pin", "revolute", "cylindrical", "prismatic", "planar", "screw"};
  bool has_axis = false;
  for (size_t i = 0; i < sizeof with_axis / sizeof *with_axis; i++)
    has_axis |= attribute_is(node, "type", with_axis[i]);
  if (!has_axis && has_attribute(node, "axis"))
    report_at(reader, node, "<joint type=\"%s\"> has no axis; expected it without the attribute 'axis'",
              attribute(node, "type"));
}

/* Reports an attribute that the type lacks but needs, or that belongs to another type only. */
static void check_attribute(struct Reader *reader, xmlNodePtr node, const char *name, const char *type,
                            bool is_needed) {
  if (attribute_is(node, "type", type) && is_needed && !has_attribute(node, name))
    report_at(reader, node, "<joint type=\"%s\"> needs the attribute '%s'; expected a number for it", type, name);
  else if (!attribute_is(node, "type", type) && has_attribute(node, name))
    report_at(reader, node, "<joint> has the attribute '%s' with type=\"%s\" alone; expected it without the attribute",
              name, type);
}

void declare_joint(struct Reader *reader, xmlNodePtr node) {
  const struct JointConstraints *type = type_of(node);
  check_axis(reader, node);
  check_attribute(reader, node, "pitch", "screw", true);
  check_attribute(reader, node, "radius", "rolling", true);
  check_attribute(reader, node, "shape", "rolling", false);
  check_attribute(reader, node, "holds", "rolling", false);
  struct Variable joint = common_attributes(reader, node);
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)}; /* the name has no value */
  scope_define(reader->scope, joint.name, word, joint.line);
  reader->present->number = reader->model->constraints.count;
  for (const enum ConstrainedQuantity *quantity = type != NULL ? type->quantities
                                                               : &(enum ConstrainedQuantity){NOTHING};
       *quantity != NOTHING; quantity++) {
    if (!is_constrained(node, *quantity)) continue;
    struct Variable constraint =
        variable_create(format_text("%s.%s", joint.name, name_of(node, *quantity)),
                        description_of(node, joint.name, *quantity), scope_line(reader->scope, joint.line));
    constraint.force_name = force_name_of(joint.name, node, *quantity);
    constraint.is_of_velocities = *quantity == SLIP_X || *quantity == SLIP_Y;
    if (has_share(*quantity)) constraint.force_share = ONE; /* until it is read */
    constraint.unit = copy_text(words[*quantity].unit);
    constraint.dimension = unit_of(constraint.unit);
    append_variable(&reader->model->constraints, constraint);
  }
}

/*
 * Returns the expression that the constraint keeps at 0. It grows as `to` moves along, or rotates about, the axis of
 * `from`. So its force is the one that `to` exerts on `from`.
 */
static Node expression_of(struct Reader *reader, xmlNodePtr node, enum ConstrainedQuantity quantity,
                          const struct JointEnd *from, const struct JointEnd *to) {
  enum { X, Y, Z };
  struct Graph *graph = reader->model->graph;
  switch (quantity) {
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
  return offset_along(graph, from, to, (int)quantity);
}

/*
 * Returns the fraction of the constraint's force along or about the axis of `from`. Antiparallel axes change its sign;
 * the torque of a universal joint is perpendicular to both of its axes.
 */
static Node share_of(struct Reader *reader, xmlNodePtr node, enum ConstrainedQuantity quantity,
                     const struct JointEnd *from, const struct JointEnd *to) {
  enum { X, Y, Z };
  struct Graph *graph = reader->model->graph;
  switch (quantity) {
  case THREAD: return slope_of_thread(reader, node, from, to);
  case ABOUT_Z: return product_of_axes(graph, from, X, to, X);
  case CROSS: return product_of_axes(graph, from, Y, to, Y);
  default: return product_of_axes(graph, from, Z, to, Z);
  }
}

void collect_joint(struct Reader *reader, xmlNodePtr node) {
  const struct JointConstraints *type = type_of(node);
  char *name = name_attribute(reader, node, "name");
  if (type == NULL || name == NULL) return;
  for (const enum ConstrainedQuantity *quantity = type->quantities; *quantity != NOTHING; quantity++)
    if (has_share(*quantity))
      definitions_add(reader->definitions, force_name_of(name, node, *quantity),
                      &(struct NamedExpression){node, "force", reader->source, NULL});
}

/* Returns the quantity whose force has this name. */
static enum ConstrainedQuantity quantity_of_force(xmlNodePtr node, const char *force_name) {
  char *joint = format_text("%.*s", (int)(strrchr(force_name, '.') - force_name), force_name);
  const enum ConstrainedQuantity *quantity = type_of(node)->quantities;
  while (strcmp(force_name_of(joint, node, *quantity), force_name) != 0) quantity++;
  return *quantity;
}

struct Quantity read_joint_force(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Model *model = reader->model;
  struct JointEnd ends[2];
  size_t i = 0;
  bool is_right = true;
  for (int end = 0; end < 2; end++) is_right &= read_joint_end_early(reader, node, end_attributes[end], &ends[end]);
  if (!is_right) return (struct Quantity){.node = ZERO};
  for (int end = 0; end < 2; end++) exchange_axes(&ends[end], shift_of(node));
  while (strcmp(constraint_force_name(&model->constraints.items[i]), name) != 0) i++;
  struct Variable *constraint = &model->constraints.items[i];
  constraint->force_share = share_of(reader, node, quantity_of_force(node, name), &ends[0], &ends[1]);
  return (struct Quantity){.node = multiply(model->graph, constraint->force_share, model->unknowns.forces[i]),
                           .dimension = constraint_force_dimension(constraint)};
}

/* True if the constraint is satisfied identically, so that it constrains nothing. */
static bool is_idle(const struct Graph *graph, const struct Variable *constraint, const struct JointEnd *from,
                    const struct JointEnd *to) {
  const struct Vector positions[] = {from->position, to->position};
  bool is_length = strcmp(constraint->unit, "m") == 0;
  return vanishes(graph, constraint->node, positions, is_length ? sizeof positions / sizeof *positions : 0);
}

/*
 * Sets constraints that are satisfied identically to 0, so that they have no force: the solution of least norm. Reports
 * constraints that cannot be satisfied, joints that constrain nothing at all, and idle constraints of rolling joints,
 * whose load coordinates would carry unnoticed.
 */
static void leave_out_idle(struct Reader *reader, xmlNodePtr node, struct Variable *first, size_t count,
                           const struct JointEnd *from, const struct JointEnd *to) {
  const struct Graph *graph = reader->model->graph;
  const char *joint = attribute(node, "name");
  size_t idle_count = 0;
  for (size_t i = 0; i < count; i++) {
    const char *quantity = strrchr(first[i].name, '.') + 1;
    bool is_idle_here = is_idle(graph, &first[i], from, to);
    idle_count += is_idle_here;
    if (is_idle_here && attribute_is(node, "type", "rolling"))
      report_at(
          reader, node,
          "the joint '%s' constrains %s, which nothing changes; expected the axes along which something moves, such "
          "as holds=\"x y\"",
          joint, quantity);
    else if (is_idle_here) first[i].node = ZERO;
    else if (graph_is_constant(graph, first[i].node))
      report_at(reader, node,
                "the joint '%s' cannot be assembled: %s is %g at all times; expected ends for which it is 0", joint,
                quantity, graph_value(graph, first[i].node));
  }
  if (idle_count == count && reader->diagnostics->errors == 0)
    report_at(reader, node,
              "nothing moves along or about the axes that the joint '%s' constrains; expected '%s' and '%s' that move "
              "against one another",
              joint, attribute(node, "from"), attribute(node, "to"));
}

/*
 * Half turns about an axis also satisfy the constraints of a fixed joint. Warns of a start nearer to a half turn about
 * axis i. There the real part of the relative quaternion is smaller than its i-th part: 2 (q0^2 - qi^2) = R[j][j] +
 * R[k][k] < 0.
 */
static void expect_pose(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from,
                        const struct JointEnd *to) {
  struct Graph *graph = reader->model->graph;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    Node cosines = add(graph, product_of_axes(graph, from, j, to, j), product_of_axes(graph, from, k, to, k));
    char *what = format_text("the joint '%s' starts nearer to a half turn about %s than to its pose (set start values "
                             "near it): the sum of the cosines between its axes %s, and %s,",
                             attribute(node, "name"), axes[i], axes[j], axes[k]);
    expect_not_negative(reader, node, what, cosines, false);
  }
}

void read_joint(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  const struct JointConstraints *type = type_of(node);
  struct JointEnd from, to;
  bool is_right = read_joint_end(reader, node, end_attributes[0], &from);
  is_right &= read_joint_end(reader, node, end_attributes[1], &to);
  if (is_right && attribute_is(node, "type", "rolling")) is_right = can_roll(reader, node, &to);
  if (type == NULL || !is_right) return;
  exchange_axes(&from, shift_of(node));
  exchange_axes(&to, shift_of(node));
  struct Variable *first = &model->constraints.items[reader->present->number];
  size_t count = 0;
  for (const enum ConstrainedQuantity *quantity = type->quantities; *quantity != NOTHING; quantity++)
    if (is_constrained(node, *quantity)) first[count++].node = expression_of(reader, node, *quantity, &from, &to);
  if (attribute_is(node, "type", "fixed")) expect_pose(reader, node, &from, &to);
  if (reader->diagnostics->errors == 0) leave_out_idle(reader, node, first, count, &from, &to);
  for (size_t i = 0; i < count && reader->diagnostics->errors == 0; i++)
    if (first[i].node != ZERO) check_constraint(reader, &first[i]);
}
