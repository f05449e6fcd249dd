/* <friction>: dry friction along a velocity, or in the plane of two velocities. */
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "model/resting_velocities.h"
#include "read/context/constraint_checks.h"
#include "read/elements/switching_reader.h"
#include "read/space/forces.h"

/* Reads the sliding velocity: that of a coordinate, or an expression. Returns false after reporting an error. */
static bool read_velocity(struct Reader *reader, xmlNodePtr node, struct Quantity *velocity) {
  bool has_coordinate = has_attribute(node, "coordinate");
  if (has_coordinate == has_attribute(node, "velocity")) {
    report_at(reader, node, "a <friction> has %s coordinate %s velocity; expected one, such as velocity=\"v - vBelt\"",
              has_coordinate ? "both" : "neither", has_coordinate ? "and" : "nor");
    return false;
  }
  if (!has_coordinate) return expression_attribute(reader, node, "velocity", IN_CONSTRAINT, velocity);
  char *name = reference_attribute(reader, node, "coordinate");
  const struct Symbol *symbol = name != NULL ? find_coordinate(reader, name) : NULL;
  if (symbol == NULL)
    report_at(reader, node, "'%s' of <friction> is not a coordinate; expected the name of one",
              name != NULL ? name : "");
  else {
    const struct Variable *variable = &reader->model->velocities.items[symbol->index];
    *velocity = (struct Quantity){.node = variable->node, .dimension = variable->dimension};
  }
  return symbol != NULL;
}

static struct Quantity read_friction_force(struct Reader *reader, xmlNodePtr node, const char *attribute_name,
                                           struct Dimension unit) {
  struct Quantity force = {.node = ZERO};
  if (expression_attribute(reader, node, attribute_name, IN_CONDITION | KIND(ACCELERATION), &force) && unit.known)
    require_unit(reader, line_of_attribute(node, attribute_name), attribute_name, force, unit);
  return force;
}

/* Reports a friction force that depends on accelerations, or nonlinearly on constraint forces. */
static void check_linear(struct Reader *reader, long line, const char *what, Node force) {
  struct Graph *graph = reader->model->graph;
  struct Gradient gradient = gradient_by_kinds(graph, force, KIND(ACCELERATION));
  for (size_t i = 0; i < gradient.count; i++) {
    const struct Symbol *symbol = graph_symbol_of(graph, gradient.symbols[i]);
    if ((size_t)symbol->index < reader->model->coordinates.count)
      report_error(reader->diagnostics, line,
                   "the %s of a friction depends on '%s'; expected the forces of contacts and constraints alone, as in "
                   "mu*ground.force",
                   what, symbol->name);
    else if (graph_depends_on(graph, gradient.values[i], ACCELERATION)) {
      report_error(reader->diagnostics, line,
                   "the %s of a friction is not linear in '%s'; expected a force such as mu*%s, or mu*N with "
                   "<state name=\"N\" rate=\"(... - N)/T\"/>, which follows another expression in a short time T",
                   what, symbol->name, symbol->name);
      return;
    }
  }
}

/* Reads the second velocity of a friction in a plane. Returns false after reporting an error. */
static bool read_across(struct Reader *reader, xmlNodePtr node, struct Dimension along, struct Quantity *velocity) {
  if (!has_attribute(node, "velocity")) {
    report_at(reader, node, "a <friction> has across without velocity; expected velocity=\"...\" beside it");
    return false;
  }
  if (!expression_attribute(reader, node, "across", IN_CONSTRAINT, velocity)) return false;
  if (along.known) require_unit(reader, line_of_attribute(node, "across"), "across", *velocity, along);
  return true;
}

/* True if a force depends on that of a contact. */
static bool follows_contact(const struct Model *model, Node force) {
  const struct Gradient gradient = gradient_by_kinds(model->graph, force, KIND(ACCELERATION));
  const struct Switches *switches = &model->switches;
  bool follows = false;
  for (size_t i = 0; i < gradient.count; i++)
    for (size_t j = 0; j < switches->contact_count; j++)
      follows |= gradient.symbols[i] == model->unknowns.forces[switches->contacts[j].constraint];
  return follows;
}

/* Reads the friction forces for negative velocities; by default they are those for positive ones. */
static void read_forces_back(struct Reader *reader, xmlNodePtr node, struct Dimension unit, struct Friction *friction) {
  bool has_force = has_attribute(node, "forceBack"), has_stiction = has_attribute(node, "stictionBack");
  friction->sliding_back = friction->sliding;
  friction->stiction_back = friction->stiction;
  if (!has_force && !has_stiction) return;
  if (friction->plane.axis != NO_PLANE)
    report_at(reader, node, "a <friction> has both across and %s; expected one force in all directions of the plane",
              has_force ? "forceBack" : "stictionBack");
  if (has_force)
    friction->sliding_back = friction->stiction_back = read_friction_force(reader, node, "forceBack", unit).node;
  if (has_stiction) friction->stiction_back = read_friction_force(reader, node, "stictionBack", unit).node;
  const struct Model *model = reader->model;
  bool differs = friction->sliding_back != friction->sliding;
  if (differs && (follows_contact(model, friction->sliding) || follows_contact(model, friction->sliding_back)))
    report_at(reader, node,
              "a <friction> has forceBack, but follows from the force of a contact; expected the force of a "
              "constraint, or one force in both directions");
}

/* Reads the friction forces. Returns false after reporting an error. */
static bool read_friction_forces(struct Reader *reader, xmlNodePtr node, struct Dimension unit,
                                 struct Friction *friction) {
  long line = reader->model->constraints.items[friction->constraint].line;
  friction->sliding = friction->stiction = read_friction_force(reader, node, "force", unit).node;
  if (has_attribute(node, "stiction")) friction->stiction = read_friction_force(reader, node, "stiction", unit).node;
  read_forces_back(reader, node, unit, friction);
  if (reader->diagnostics->errors > 0) return false;
  check_linear(reader, line, "force", friction->sliding);
  if (has_attribute(node, "stiction")) check_linear(reader, line, "stiction", friction->stiction);
  if (has_attribute(node, "forceBack")) check_linear(reader, line, "forceBack", friction->sliding_back);
  if (has_attribute(node, "stictionBack")) check_linear(reader, line, "stictionBack", friction->stiction_back);
  return true;
}

static void set_velocity(struct Reader *reader, xmlNodePtr node, struct Friction *friction, Node velocity) {
  if (velocity != ZERO && !graph_depends_on(reader->model->graph, velocity, VELOCITY))
    report_at(reader, node,
              "the velocity %sof a <friction> depends on no velocity; expected an expression such as v - vBelt",
              friction->plane.axis == ACROSS ? "across " : "");
  friction->velocity = velocity;
}

/* Sets the constraint velocity = 0, which applies while the friction sticks. */
static void hold_velocity(struct Reader *reader, const struct Friction *friction, struct Dimension unit) {
  struct Graph *graph = reader->model->graph;
  struct Variable *constraint = &reader->model->constraints.items[friction->constraint];
  constraint->is_of_velocities = true;
  constraint->dimension = dimension_multiply(unit_of("W"), unit, -1.0);
  scope_set_dimension(reader->scope, constraint_force_name(constraint), unit);
  constraint->node = function(graph, GUARD, friction_sticks(graph, friction), friction->velocity);
  if (friction->velocity != ZERO) check_constraint(reader, constraint);
}

/* Adds the force of a sliding friction against its velocity. */
static void add_sliding_force(struct Reader *reader, const struct Friction *friction) {
  struct Graph *graph = reader->model->graph;
  Node reaction = negate(graph, sliding_force(graph, friction));
  const struct Gradient gradient = gradient_by_kinds(graph, friction->velocity, KIND(VELOCITY));
  add_virtual_work(reader->model, reaction, &gradient);
}

/* True if the friction may be at its stiction while others keep its velocity at 0. Contacts share their loads. */
static bool has_static_limit(const struct Model *model, const struct Friction *friction) {
  bool differs = friction->stiction != friction->sliding || friction->stiction_back != friction->sliding_back;
  return differs && friction->plane.axis == NO_PLANE && model->constraints.count > 1 &&
         !follows_contact(model, friction->sliding) && !follows_contact(model, friction->stiction);
}

void complete_friction(struct Reader *reader, struct Friction *friction, struct Dimension unit) {
  size_t parts = friction->plane.axis == NO_PLANE ? 1 : 2;
  for (size_t i = 0; i < parts; i++) {
    friction[i].sliding = friction->sliding;
    friction[i].stiction = friction->stiction;
    friction[i].sliding_back = friction->sliding_back;
    friction[i].stiction_back = friction->stiction_back;
    hold_velocity(reader, &friction[i], unit);
  }
  friction->has_static_limit = has_static_limit(reader->model, friction);
  if (parts == 1 && reader->diagnostics->errors == 0) add_sliding_force(reader, friction);
}

void add_sliding_forces_in_planes(struct Reader *reader) {
  const struct Switches *switches = &reader->model->switches;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (switches->frictions[i].plane.axis != NO_PLANE) add_sliding_force(reader, &switches->frictions[i]);
}

void read_friction(struct Reader *reader, xmlNodePtr node) {
  struct Friction *friction = &reader->model->switches.frictions[reader->present->number];
  size_t parts = has_attribute(node, "across") ? 2 : 1;
  struct Quantity velocity = {.node = ZERO}, across = {.node = ZERO};
  if (!read_velocity(reader, node, &velocity)) return;
  set_velocity(reader, node, friction, velocity.node);
  if (parts > 1 && !read_across(reader, node, velocity.dimension, &across)) return;
  if (parts > 1) set_velocity(reader, node, friction + 1, across.node);
  struct Dimension unit = dimension_multiply(unit_of("W"), velocity.dimension, -1.0);
  if (read_friction_forces(reader, node, unit, friction)) complete_friction(reader, friction, unit);
}

void complete_friction_forces(struct Reader *reader) {
  struct Model *model = reader->model;
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  if (switches->friction_count == 0) return;
  Node *replacements = own_symbols(graph);
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct Friction *friction = &switches->frictions[i];
    Node force = model->unknowns.forces[friction->constraint];
    replacements[graph->vertices[force].left] = friction_force(graph, friction, force);
  }
  substitute_in_observers(model, replacements);
}
