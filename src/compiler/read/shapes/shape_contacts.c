#include "read/shapes/shape_contacts.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/variables.h"
#include "names/piecewise_functions.h"
#include "read/shapes/shape_meshes.h"
#include "read/shapes/shapes.h"
#include "read/shapes/tangents.h"
#include "read/space/forces.h"

/* m/s: default regularization of friction, which is proportional to the velocity below it. */
static const double usual_creep = 1e-3;

/* Parameters of a compliant contact: N/m, s/m, a coefficient, m/s. */
struct CompliantLaw {
  Node stiffness, damping, friction, creep;
};

/*
 * The velocity of the first shape relative to the second at points that a carrier has, along the base's axes. It is
 * common + by_offset times the offset of the point's ball, which shares what the points of a shape have in common.
 */
struct SlidingField {
  struct Vector common;
  struct Matrix by_offset;
};

/* Two shapes with their poses, and the points at which they may touch. */
struct ShapeContact {
  struct ContactSide first, second;
  struct ContactPoints contacts;
  struct SlidingField sliding; /* if the points have a carrier */
};

bool is_of_shapes(xmlNodePtr node) {
  return has_attribute(node, "between");
}

bool is_compliant(xmlNodePtr node) {
  return has_attribute(node, "stiffness");
}

bool has_shape_friction(xmlNodePtr node) {
  return has_attribute(node, "friction");
}

static void check_attributes(struct Reader *reader, xmlNodePtr node) {
  static const char *const of_compliance[] = {"damping", "creep"}, *const of_rigidity[] = {"restitution", "stiction"};
  if (has_attribute(node, "gap")) report_at(reader, node, "a <contact> has both gap and between; expected one of them");
  if (!has_attribute(node, "and"))
    report_at(reader, node, "a <contact> names one shape; expected and=\"...\" with the other");
  for (size_t i = 0; i < sizeof of_compliance / sizeof *of_compliance; i++)
    if (!is_compliant(node) && has_attribute(node, of_compliance[i]))
      report_at(reader, node,
                "a <contact> between shapes has %s without stiffness; expected stiffness=\"...\" in N/m beside it",
                of_compliance[i]);
  for (size_t i = 0; i < sizeof of_rigidity / sizeof *of_rigidity; i++)
    if (is_compliant(node) && has_attribute(node, of_rigidity[i]))
      report_at(reader, node, "a <contact> has both stiffness and %s; expected %s=\"...\" in place of the latter",
                of_rigidity[i], i == 0 ? "damping" : "creep");
  if (has_attribute(node, "stiction") && !has_shape_friction(node))
    report_at(reader, node, "a <contact> has stiction without friction; expected friction=\"...\" beside it");
}

/* Returns the name of a type that can touch planes only, other than boxes and cylinders; NULL for other types. */
static const char *only_on_planes(const struct ContactShape *shape) {
  return shape->type == SHAPE_MESH ? "a mesh" : shape->type == SHAPE_ELLIPSOID ? "an ellipsoid" : NULL;
}

static bool are_boxes(const struct ContactShape *shapes[2]) {
  return shapes[0]->type == SHAPE_BOX && shapes[1]->type == SHAPE_BOX;
}

/* Returns false after reporting two boxes whose contact is rigid, or one of which is flat. */
static bool check_boxes(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shapes[2]) {
  if (!are_boxes(shapes)) return true;
  if (!is_compliant(node)) {
    report_at(reader, node,
              "the <contact> of the boxes '%s' and '%s' is rigid; expected stiffness=\"...\" in N/m, or a plane in "
              "place of one of them",
              shapes[0]->name, shapes[1]->name);
    return false;
  }
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      if (shapes[i]->is_flat[axis]) {
        report_at(
            reader, node,
            "the box '%s' has no size along %c, and touches no other box; expected a size above 0 along each axis",
            shapes[i]->name, "xyz"[axis]);
        return false;
      }
  return true;
}

/* Expects sizes above 0 of two boxes, whose sizes may be parameters. */
static void expect_solid_boxes(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shapes[2]) {
  if (!are_boxes(shapes)) return;
  for (int i = 0; i < 6; i++) {
    const struct ContactShape *box = shapes[i / 3];
    const char *what = format_text("the size of the box '%s' along %c", box->name, "xyz"[i % 3]);
    expect_size(reader, node, what, box->size.along[i % 3], true);
  }
}

/* Finds both shapes. Returns false after reporting that one is missing or that they cannot touch. */
static bool find_shapes(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shapes[2]) {
  shapes[0] = shape_of_attribute(reader, node, "between");
  shapes[1] = shape_of_attribute(reader, node, "and");
  if (shapes[0] == NULL || shapes[1] == NULL) return false;
  if (shapes[0] == shapes[1]) {
    report_at(reader, node, "a <contact> is between '%s' and itself; expected two shapes", shapes[0]->name);
    return false;
  }
  for (int i = 0; i < 2; i++)
    if (shapes[1 - i]->type == SHAPE_PLANE && !prepare_corners(reader, node, shapes[i])) return false;
  if (!check_boxes(reader, node, shapes)) return false;
  if (count_contact_points(shapes[0], shapes[1]) > 0) return true;
  const char *type = only_on_planes(shapes[0]);
  if (type == NULL) type = only_on_planes(shapes[1]);
  if (type != NULL) {
    report_at(reader, node, "there is no <contact> between '%s' and '%s', of which one is %s; expected a plane for it",
              shapes[0]->name, shapes[1]->name, type);
    return false;
  }
  report_at(
      reader, node,
      "there is no <contact> between such shapes as '%s' and '%s'; expected a sphere or a plane as one of them, two "
      "capsules, two boxes, or a capsule and a box",
      shapes[0]->name, shapes[1]->name);
  return false;
}

size_t count_shape_contacts(struct Reader *reader, xmlNodePtr node) {
  const struct ContactShape *shapes[2];
  check_attributes(reader, node);
  return find_shapes(reader, node, shapes) ? count_contact_points(shapes[0], shapes[1]) : 0;
}

/* Returns the velocity of the material of a shape at a point, along the base's axes. */
static struct Vector velocity_of_point(struct Graph *graph, const struct ContactSide *side, struct Vector point) {
  struct Vector lever_arm = vector_subtract(graph, point, side->pose.origin), none = {{ZERO, ZERO, ZERO}};
  struct Vector offset = matrix_apply_transposed(graph, &side->pose.rotation, lever_arm);
  return matrix_apply(graph, &side->pose.rotation, velocity_at(graph, &side->pose, offset, none));
}

/* Returns the angular velocity of the first shape relative to the second, along the base's axes. */
static struct Vector relative_spin(struct Graph *graph, const struct ShapeContact *contact) {
  const struct Pose *first = &contact->first.pose, *second = &contact->second.pose;
  return vector_subtract(graph, matrix_apply(graph, &first->rotation, first->angular_velocity),
                         matrix_apply(graph, &second->rotation, second->angular_velocity));
}

/* Returns column i of the rotation matrix of a pose: an axis of its frame, along the base's axes. */
static struct Vector axis_of_pose(const struct Pose *pose, int i) {
  return (struct Vector){
      {pose->rotation.row[0].along[i], pose->rotation.row[1].along[i], pose->rotation.row[2].along[i]}};
}

/* Returns the field v + W x (R offset + below), with the velocity v at the carrier's origin and the spin W. */
static struct SlidingField sliding_field_of(struct Graph *graph, const struct ShapeContact *contact) {
  const struct Pose *carrier = &contact->contacts.carrier->pose;
  struct Vector spin = relative_spin(graph, contact);
  struct Vector velocity = vector_subtract(graph, velocity_of_point(graph, &contact->first, carrier->origin),
                                           velocity_of_point(graph, &contact->second, carrier->origin));
  struct SlidingField field = {.common =
                                   vector_add(graph, velocity, vector_cross(graph, spin, contact->contacts.below))};
  for (int i = 0; i < 3; i++) {
    struct Vector column = vector_cross(graph, spin, axis_of_pose(carrier, i));
    for (int j = 0; j < 3; j++) field.by_offset.row[j].along[i] = column.along[j];
  }
  return field;
}

/* Returns the velocity of the first shape relative to the second one at a contact point, along the base's axes. */
static struct Vector sliding_of_contact(struct Graph *graph, const struct ShapeContact *contact,
                                        const struct ContactPoint *point) {
  if (contact->contacts.carrier != NULL)
    return vector_add(graph, contact->sliding.common, matrix_apply(graph, &contact->sliding.by_offset, point->offset));
  return vector_subtract(graph, velocity_of_point(graph, &contact->first, point->point),
                         velocity_of_point(graph, &contact->second, point->point));
}

/* True if coordinates move the shapes relative to each other at the contact point: in translation or rotation. */
static bool moves_contact(struct Graph *graph, const struct ShapeContact *contact, const struct ContactPoint *point) {
  struct Vector spin = relative_spin(graph, contact), sliding = sliding_of_contact(graph, contact, point);
  bool moves = graph_depends_on(graph, point->gap, COORDINATE);
  for (int i = 0; i < 3; i++)
    moves |= graph_depends_on(graph, sliding.along[i], VELOCITY) || graph_depends_on(graph, spin.along[i], VELOCITY);
  return moves;
}

/*
 * Returns false after reporting shapes without relative motion. Rigid contacts also need a coordinate along the normal,
 * which determines the normal force.
 */
static bool check_motion(struct Reader *reader, xmlNodePtr node, const struct ShapeContact *contact) {
  struct Graph *graph = reader->model->graph;
  const char *first = contact->first.shape->name, *second = contact->second.shape->name;
  for (size_t i = 0; i < contact->contacts.count; i++) {
    const struct ContactPoint *point = &contact->contacts.items[i];
    if (!moves_contact(graph, contact, point)) {
      report_at(reader, node, "nothing moves '%s' against '%s'; expected shapes of bodies or frames that move", first,
                second);
      return false;
    }
    if (is_compliant(node) || graph_depends_on(graph, point->gap, COORDINATE)) continue;
    report_at(reader, node,
              "no coordinate moves '%s' towards '%s' or away from it, so that the force between them is not "
              "determined; expected such a coordinate, or stiffness=\"...\" in N/m",
              first, second);
    return false;
  }
  return true;
}

/* Warns of balls whose centre is in the other shape at the start. */
static void expect_centres_outside(struct Reader *reader, xmlNodePtr node, const struct ShapeContact *contact) {
  for (size_t i = 0; i < contact->contacts.count; i++)
    if (contact->contacts.items[i].distance != ZERO)
      expect_size(reader, node,
                  format_text("the distance of '%s' and '%s' without their radii", contact->first.shape->name,
                              contact->second.shape->name),
                  contact->contacts.items[i].distance, false);
}

static bool read_contact_of_shapes(struct Reader *reader, xmlNodePtr node, struct ShapeContact *contact) {
  const struct ContactShape *shapes[2];
  long line = line_of(node);
  if (reader->diagnostics->errors > 0 || !find_shapes(reader, node, shapes)) return false;
  contact->first = contact_side_of(reader, line, shapes[0]);
  contact->second = contact_side_of(reader, line, shapes[1]);
  contact->contacts = contact_points_of(reader, line, &contact->first, &contact->second, !is_compliant(node));
  if (contact->contacts.carrier != NULL) contact->sliding = sliding_field_of(reader->model->graph, contact);
  expect_centres_outside(reader, node, contact);
  expect_solid_boxes(reader, node, shapes);
  return check_motion(reader, node, contact);
}

const struct RigidContact *rigid_contacts(struct Reader *reader, xmlNodePtr node) {
  struct ShapeContact contact;
  if (!read_contact_of_shapes(reader, node, &contact)) return NULL;
  struct RigidContact *contacts = allocate(contact.contacts.count, sizeof *contacts);
  for (size_t i = 0; i < contact.contacts.count; i++) {
    const struct ContactPoint *point = &contact.contacts.items[i];
    contacts[i].gap = point->gap;
    if (has_shape_friction(node)) contacts[i].slip = slip_of_contact(reader, &contact.first, &contact.second, point);
  }
  return contacts;
}

static Node read_law_attribute(struct Reader *reader, xmlNodePtr node, const char *name, const char *unit, Node usual) {
  struct Quantity value = {.node = usual};
  if (!expression_attribute(reader, node, name, IN_MASS, &value)) return usual;
  require_unit(reader, line_of_attribute(node, name), name, value, unit_of(unit));
  expect_not_negative(reader, node, format_text("the %s of <contact>", name), value.node, false);
  return value.node;
}

struct FrictionCoefficients read_grip(struct Reader *reader, xmlNodePtr node) {
  struct FrictionCoefficients grip = {.friction = read_law_attribute(reader, node, "friction", "1", ZERO)};
  grip.stiction = read_law_attribute(reader, node, "stiction", "1", grip.friction);
  return grip;
}

/* Returns a condition that is positive where the sign of the damped force matters. */
static Node where_pressed(struct Scope *scope, Node is_apart) {
  struct Graph *graph = scope->graph;
  if (scope->switches == NULL) return ONE;
  Node condition = choose_node(graph, mode_of_importer(scope->switches, graph), ONE, negate(graph, is_apart));
  append_condition(scope->switches, condition);
  return condition;
}

/*
 * Returns the normal force stiffness depth (1 + damping d depth/dt) during contact, and 0 if that is negative: contacts
 * do not pull. is_apart: positive where there is no contact.
 */
static Node pressing_force(struct Reader *reader, long line, const struct CompliantLaw *law, Node gap, Node is_apart) {
  struct Scope *scope = reader->scope;
  struct Graph *graph = scope->graph;
  Node rate = negate(graph, total_time_derivative(scope, gap));
  Node factor = add(graph, ONE, multiply(graph, law->damping, rate));
  if (law->damping != ZERO) {
    scope->relevance = where_pressed(scope, is_apart);
    factor = piecewise_function(scope, MAXIMUM, factor, ZERO, line);
    scope->relevance = ONE;
  }
  Node force = multiply(graph, multiply(graph, law->stiffness, negate(graph, gap)), factor);
  return choose_node(graph, is_apart, ZERO, force);
}

/*
 * Returns the force on the first shape: the normal force N and the friction -mu N v / sqrt(v^2 + creep^2) against the
 * tangential velocity v.
 */
static struct Vector force_of_contact(struct Graph *graph, const struct CompliantLaw *law,
                                      const struct ShapeContact *contact, const struct ContactPoint *point,
                                      Node pressing) {
  struct Vector force = vector_scale(graph, pressing, point->normal);
  if (law->friction == ZERO) return force;
  struct Vector sliding = sliding_of_contact(graph, contact, point);
  Node along = vector_dot(graph, sliding, point->normal);
  sliding = vector_subtract(graph, sliding, vector_scale(graph, along, point->normal));
  Node squares = add(graph, vector_dot(graph, sliding, sliding), power_number(graph, law->creep, 2.0));
  Node factor = multiply(graph, multiply(graph, law->friction, pressing), power_number(graph, squares, -0.5));
  return vector_subtract(graph, force, vector_scale(graph, factor, sliding));
}

/* The sums over all points: of the normal forces, of the forces on the first shape, and what its torques need. */
struct ContactLoad {
  Node pressing;
  struct Vector force;
  struct Vector moments[3]; /* sums of the forces times a component of the offset, if the points have a carrier */
};

static void add_to_load(struct Graph *graph, struct ContactLoad *load, const struct ContactPoint *point, Node pressing,
                        struct Vector force) {
  load->pressing = add(graph, load->pressing, pressing);
  load->force = vector_add(graph, load->force, force);
  for (int i = 0; i < 3; i++)
    load->moments[i] = vector_add(graph, load->moments[i], vector_scale(graph, point->offset.along[i], force));
}

/* Makes the load 0 without its computation where no point touches, so that shapes out of reach cost nothing. */
static void guard_load(struct Graph *graph, struct ContactLoad *load, Node touches) {
  load->pressing = function(graph, GUARD, touches, load->pressing);
  for (int i = 0; i < 3; i++) {
    load->force.along[i] = function(graph, GUARD, touches, load->force.along[i]);
    for (int j = 0; j < 3; j++) load->moments[i].along[j] = function(graph, GUARD, touches, load->moments[i].along[j]);
  }
}

/* Returns a mode that is positive while a point does not touch. */
static Node mode_apart(struct Scope *scope, long line, Node are_near, Node gap) {
  scope->relevance = are_near;
  Node is_apart = branch_of(scope, gap, "the gap of the contact", line);
  scope->relevance = ONE;
  return choose_node(scope->graph, are_near, is_apart, ONE);
}

/* Returns the load. A point is apart where its mode is 1, so that the modes of n points add up to n unless one touches. */
static struct ContactLoad load_of_contact(struct Reader *reader, long line, const struct CompliantLaw *law,
                                          const struct ShapeContact *contact, Node *touches) {
  struct Graph *graph = reader->model->graph;
  struct Vector none = {{ZERO, ZERO, ZERO}};
  struct ContactLoad load = {ZERO, none, {none, none, none}};
  *touches = graph_constant(graph, (double)contact->contacts.count);
  for (size_t i = 0; i < contact->contacts.count; i++) {
    const struct ContactPoint *point = &contact->contacts.items[i];
    Node is_apart = mode_apart(reader->scope, line, contact->contacts.are_near, point->gap);
    Node pressing = pressing_force(reader, line, law, point->gap, is_apart);
    add_to_load(graph, &load, point, pressing, force_of_contact(graph, law, contact, point, pressing));
    *touches = subtract(graph, *touches, is_apart);
  }
  append_condition(&reader->model->switches, *touches);
  guard_load(graph, &load, *touches);
  return load;
}

/*
 * Returns the torque of the load about the origin of a side. A carrier's points have the lever arms R offset + below:
 * the sum over i of axis i x moment i, and below x force. Otherwise there is one point.
 */
static struct Vector torque_of_load(struct Graph *graph, const struct ContactPoints *points,
                                    const struct ContactSide *side, const struct ContactLoad *load) {
  const struct ContactSide *carrier = points->carrier;
  if (carrier == NULL)
    return vector_cross(graph, vector_subtract(graph, points->items[0].point, side->pose.origin), load->force);
  struct Vector arm = vector_add(graph, vector_subtract(graph, carrier->pose.origin, side->pose.origin), points->below);
  struct Vector torque = vector_cross(graph, arm, load->force);
  for (int i = 0; i < 3; i++)
    torque = vector_add(graph, torque, vector_cross(graph, axis_of_pose(&carrier->pose, i), load->moments[i]));
  return torque;
}

/* Adds the load, or with sign -1 its opposite, to the frame or particle of a side. */
static void add_load_on(struct Reader *reader, long line, const struct ContactSide *side, double sign,
                        const struct ContactPoints *points, const struct ContactLoad *load) {
  struct Graph *graph = reader->model->graph;
  const struct Mechanism *mechanism = &reader->model->mechanism;
  const struct ContactShape *shape = side->shape;
  const struct ReferenceFrame *frame = &mechanism->frames[shape->frame];
  bool is_particle = shape->particle != NO_PARTICLE;
  for (int i = 0; i < 3; i++) {
    Node position = is_particle ? mechanism->bodies[shape->particle].displaced[i] : frame->pose.origin.along[i];
    add_force_along(reader, line, shape->name, position, scale(graph, sign, load->force.along[i]));
  }
  if (is_particle) return;
  struct Vector torque = torque_of_load(graph, points, side, load);
  add_torque_on(reader, line, vector_scale(graph, graph_constant(graph, sign), torque), frame);
}

/* Lets messages name the contact where the centre of its ball comes into the other shape. */
static void note_ball(struct Reader *reader, xmlNodePtr node, const struct ContactPoint *point) {
  struct Graph *graph = reader->model->graph;
  char *name = attribute(node, "name");
  if (point->distance == ZERO || name == NULL) return;
  Node radii = subtract(graph, point->distance, point->gap);
  append_ball(&reader->model->switches, (struct BallContact){name, divide(graph, point->distance, radii)});
}

static void append_force(struct Reader *reader, xmlNodePtr node, Node force) {
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  struct Variable variable = variable_create(format_text("%s.force", name),
                                             format_text("force with which %s presses '%s' and '%s' apart", name,
                                                         attribute(node, "between"), attribute(node, "and")),
                                             line_of(node));
  variable.unit = copy_text("N");
  variable.dimension = unit_of("N");
  variable.node = force;
  scope_define(reader->scope, variable.name, (struct Quantity){.node = force, .dimension = variable.dimension},
               variable.line);
  append_variable(&reader->model->mechanism.element_variables, variable);
}

/* Adds the load to both shapes. Its generalized forces are guarded, too. */
static void add_load(struct Reader *reader, long line, const struct ShapeContact *contact,
                     const struct ContactLoad *load, Node touches) {
  struct Model *model = reader->model;
  struct Quantity *sums = model->forces.along;
  model->forces.along = allocate(model->coordinates.count, sizeof *model->forces.along);
  add_load_on(reader, line, &contact->first, 1.0, &contact->contacts, load);
  add_load_on(reader, line, &contact->second, -1.0, &contact->contacts, load);
  for (size_t i = 0; i < model->coordinates.count; i++)
    add_term(model, &sums[i], function(model->graph, GUARD, touches, model->forces.along[i].node));
  model->forces.along = sums;
}

void read_compliant_contact(struct Reader *reader, xmlNodePtr node) {
  struct Graph *graph = reader->model->graph;
  struct ShapeContact contact;
  long line = line_of(node);
  struct CompliantLaw law = {.stiffness = read_law_attribute(reader, node, "stiffness", "N/m", ZERO),
                             .damping = read_law_attribute(reader, node, "damping", "s/m", ZERO),
                             .friction = read_law_attribute(reader, node, "friction", "1", ZERO)};
  law.creep = read_law_attribute(reader, node, "creep", "m/s", graph_constant(graph, usual_creep));
  if (law.creep == ZERO)
    report_at(reader, node, "the creep of a <contact> is 0; expected a speed above 0, such as 1e-4 m/s");
  if (!read_contact_of_shapes(reader, node, &contact)) return;
  reader->model->forces.any = true;
  Node touches;
  struct ContactLoad load = load_of_contact(reader, line, &law, &contact, &touches);
  for (size_t i = 0; i < contact.contacts.count; i++) note_ball(reader, node, &contact.contacts.items[i]);
  add_load(reader, line, &contact, &load, touches);
  append_force(reader, node, load.pressing);
}
