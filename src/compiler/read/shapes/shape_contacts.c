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

/* Two shapes with their poses, and the points at which they may touch. */
struct ShapeContact {
  struct ContactSide first, second;
  struct ContactPoints contacts;
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
  if (count_contact_points(shapes[0], shapes[1]) > 0) return true;
  const char *type = only_on_planes(shapes[0]);
  if (type == NULL) type = only_on_planes(shapes[1]);
  if (type != NULL) {
    report_at(reader, node, "there is no <contact> between '%s' and '%s', of which one is %s; expected a plane for it",
              shapes[0]->name, shapes[1]->name, type);
    return false;
  }
  report_at(reader, node,
            "there is no <contact> between such shapes as '%s' and '%s'; expected a sphere or capsule as one of them, "
            "or a plane",
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

/* Returns the velocity of the first shape relative to the second one at a contact point, along the base's axes. */
static struct Vector sliding_of_contact(struct Graph *graph, const struct ShapeContact *contact,
                                        const struct ContactPoint *point) {
  return vector_subtract(graph, velocity_of_point(graph, &contact->first, point->point),
                         velocity_of_point(graph, &contact->second, point->point));
}

/* True if coordinates move the shapes relative to each other at the contact point: in translation or rotation. */
static bool moves_contact(struct Graph *graph, const struct ShapeContact *contact, const struct ContactPoint *point) {
  const struct Pose *first = &contact->first.pose, *second = &contact->second.pose;
  struct Vector spin = vector_subtract(graph, matrix_apply(graph, &first->rotation, first->angular_velocity),
                                       matrix_apply(graph, &second->rotation, second->angular_velocity));
  struct Vector sliding = sliding_of_contact(graph, contact, point);
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
  contact->contacts = contact_points_of(reader, line, &contact->first, &contact->second);
  expect_centres_outside(reader, node, contact);
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

/*
 * Returns the normal force stiffness depth (1 + damping d depth/dt) during contact, and 0 if that is negative: contacts
 * do not pull.
 */
static Node pressing_force(struct Reader *reader, long line, const struct CompliantLaw *law, Node gap) {
  struct Scope *scope = reader->scope;
  struct Graph *graph = scope->graph;
  Node is_apart = branch_of(scope, gap, "the gap of the contact", line);
  Node rate = negate(graph, total_time_derivative(scope, gap));
  Node factor = add(graph, ONE, multiply(graph, law->damping, rate));
  if (law->damping != ZERO) factor = piecewise_function(scope, MAXIMUM, factor, ZERO, line);
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

/* Adds a force at a point of a shape to its frame or particle. */
static void add_force_on(struct Reader *reader, long line, const struct ContactSide *side, struct Vector point,
                         struct Vector force) {
  struct Graph *graph = reader->model->graph;
  const struct Mechanism *mechanism = &reader->model->mechanism;
  const struct ContactShape *shape = side->shape;
  const struct ReferenceFrame *frame = &mechanism->frames[shape->frame];
  bool is_particle = shape->particle != NO_PARTICLE;
  for (int i = 0; i < 3; i++) {
    Node position = is_particle ? mechanism->bodies[shape->particle].displaced[i] : frame->pose.origin.along[i];
    add_force_along(reader, line, shape->name, position, force.along[i]);
  }
  if (is_particle) return;
  struct Vector lever_arm = vector_subtract(graph, point, side->pose.origin);
  add_torque_on(reader, line, vector_cross(graph, lever_arm, force), frame);
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
  Node sum = ZERO;
  for (size_t i = 0; i < contact.contacts.count; i++) {
    const struct ContactPoint *point = &contact.contacts.items[i];
    Node pressing = pressing_force(reader, line, &law, point->gap);
    struct Vector force = force_of_contact(graph, &law, &contact, point, pressing);
    add_force_on(reader, line, &contact.first, point->point, force);
    add_force_on(reader, line, &contact.second, point->point, vector_scale(graph, graph_constant(graph, -1.0), force));
    note_ball(reader, node, point);
    sum = add(graph, sum, pressing);
  }
  append_force(reader, node, sum);
}
