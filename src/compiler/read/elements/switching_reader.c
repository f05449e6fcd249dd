#include "read/elements/switching_reader.h"

#include <math.h>
#include <string.h>

#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/constraint_checks.h"
#include "read/context/includes.h"
#include "read/context/variables.h"
#include "read/elements/start_expressions.h"
#include "read/shapes/shape_contacts.h"
#include "read/space/forces.h"

/* Kinds of symbols in gaps of contacts and limits of stops. */
enum { IN_GAP = IN_CONSTRAINT & ~KIND(VELOCITY) };

/* --- Declarations --- */

Node new_mode(struct Reader *reader, const char *of, const char *what) {
  return next_mode(&reader->model->switches, reader->model->graph, format_text("%s.%s", of, what));
}

/* Adds a mode that expressions know by name: the observed mode of a contact or friction, a variable of the FMU. */
static Node new_reported_mode(struct Reader *reader, const struct Variable *constraint, const char *what) {
  Node mode = new_mode(reader, constraint->name, what);
  char *name = format_text("%s.%s", constraint->name, what);
  scope_define(reader->scope, name, (struct Quantity){.node = mode, .dimension = dimension_one}, constraint->line);
  return mode;
}

void declare_mode(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable mode = common_attributes(reader, node);
  overrides_of(reader, node, mode.name); /* marks overrides as used; start_expressions.c reads them */
  mode.start = preliminary_start(node, "start");
  reader->present->number = model->modes.count;
  int index = (int)model->switches.mode_count++;
  struct Dimension dimension = mode.unit != NULL ? mode.dimension : dimension_one;
  mode.node = scope_symbol(reader->scope, MODE, index, mode.name, dimension, mode.line);
  mode.line = scope_line(reader->scope, mode.line);
  append_variable(&model->modes, mode);
}

/* Appends a constraint that applies while a mode is on. Returns its index. */
static size_t declare_switched_constraint(struct Reader *reader, struct Variable constraint) {
  struct VariableList *constraints = &reader->model->constraints;
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  scope_define(reader->scope, constraint.name, word, constraint.line);
  constraint.line = scope_line(reader->scope, constraint.line);
  append_variable(constraints, constraint);
  return constraints->count - 1;
}

static void append_contact(struct Reader *reader, struct Variable constraint) {
  struct Switches *switches = &reader->model->switches;
  APPEND(switches->contacts, switches->contact_count,
         (struct Contact){.mode = new_reported_mode(reader, &constraint, "closed")});
  switches->contacts[switches->contact_count - 1].constraint = declare_switched_constraint(reader, constraint);
}

/* Returns the constraint of one end of a stop, named x.min or x.max. */
static struct Variable end_of_stop(xmlNodePtr node, const char *coordinate, const char *end) {
  return variable_create(format_text("%s.%s", coordinate, end),
                         format_text("stop of %s at its %simum", coordinate, end), line_of(node));
}

void declare_stop(struct Reader *reader, xmlNodePtr node) {
  char *coordinate = reference_attribute(reader, node, "coordinate");
  reader->present->number = reader->model->switches.contact_count;
  if (!has_attribute(node, "min") && !has_attribute(node, "max"))
    report_at(reader, node, "a <stop> has neither min nor max; expected one of them, or both");
  if (coordinate != NULL && has_attribute(node, "min")) append_contact(reader, end_of_stop(node, coordinate, "min"));
  if (coordinate != NULL && has_attribute(node, "max")) append_contact(reader, end_of_stop(node, coordinate, "max"));
}

/* Appends a friction whose constraint follows. The pointer is valid until the next call. */
static struct Friction *append_friction(struct Reader *reader, struct Friction friction) {
  struct Switches *switches = &reader->model->switches;
  APPEND(switches->frictions, switches->friction_count, friction);
  return &switches->frictions[switches->friction_count - 1];
}

/* Turns the last friction into the first axis of a friction in a plane, and appends the second axis. */
static void declare_plane(struct Reader *reader, struct Friction *along, struct Variable constraint) {
  const char *name = constraint.name;
  along->plane.axis = ALONG;
  along->plane.slip_direction = new_mode(reader, name, "heading");
  struct Friction across = *along;
  across.plane.axis = ACROSS;
  across.plane.slip_direction = new_mode(reader, name, "across.heading");
  along->plane.lower = across.plane.lower = new_mode(reader, name, "lower");
  along->plane.upper = across.plane.upper = new_mode(reader, name, "upper");
  constraint.name = format_text("%s.across", name);
  if (constraint.description != NULL) constraint.description = format_text("%s, across", constraint.description);
  across.constraint = declare_switched_constraint(reader, constraint);
  append_friction(reader, across);
}

static void declare_friction_of(struct Reader *reader, struct Variable constraint, bool is_in_plane) {
  Node mode = new_mode(reader, constraint.name, "sliding"),
       reported = new_reported_mode(reader, &constraint, "sliding");
  struct Friction *friction = append_friction(reader, (struct Friction){.mode = mode, .reported = reported});
  friction->constraint = declare_switched_constraint(reader, constraint);
  if (is_in_plane) declare_plane(reader, friction, constraint);
  reader->model->forces.any = true;
}

void declare_friction(struct Reader *reader, xmlNodePtr node) {
  reader->present->number = reader->model->switches.friction_count;
  declare_friction_of(reader, common_attributes(reader, node), has_attribute(node, "across"));
}

/* Declares the friction of a contact. Its constraints follow that of the contact. */
static void declare_friction_of_contact(struct Reader *reader, const struct Variable *contact) {
  struct Variable constraint = variable_create(format_text("%s.friction", contact->name),
                                               format_text("friction of %s", contact->name), contact->line);
  declare_friction_of(reader, constraint, true);
}

/* Declares a contact for each point at which the shapes may touch: NAME, or NAME[1], NAME[2], ... */
static void declare_shape_contact(struct Reader *reader, xmlNodePtr node) {
  size_t count = count_shape_contacts(reader, node);
  if (is_compliant(node)) return;
  if (!has_attribute(node, "name")) {
    report_at(reader, node, "a rigid <contact> has no name; expected name=\"...\"");
    return;
  }
  struct Variable contact = common_attributes(reader, node);
  for (size_t i = 1; i <= count; i++) {
    struct Variable one = contact;
    if (count > 1) one.name = format_text("%s[%zu]", contact.name, i);
    one.unit = copy_text("m");
    one.dimension = unit_of("m");
    append_contact(reader, one);
    if (has_shape_friction(node)) declare_friction_of_contact(reader, &one);
  }
}

static bool is_of_gap(xmlNodePtr node) {
  return !is_of_shapes(node) && has_attribute(node, "gap") && has_attribute(node, "name");
}

void declare_contact(struct Reader *reader, xmlNodePtr node) {
  reader->present->number = reader->model->switches.contact_count;
  if (is_of_shapes(node)) declare_shape_contact(reader, node);
  else if (is_of_gap(node)) append_contact(reader, common_attributes(reader, node));
  else
    report_at(reader, node,
              "a <contact> has neither a name with a gap nor two shapes; expected name=\"...\" gap=\"...\", or "
              "between=\"...\" and=\"...\"");
}

/* Gives contacts, and frictions along lines, a force beside their constraints: frictions may share loads with others. */
static void declare_carried_forces(struct Reader *reader) {
  struct Switches *switches = &reader->model->switches;
  if (switches->friction_count == 0 || (switches->contact_count == 0 && !has_planes(switches))) return;
  for (size_t i = 0; i < switches->friction_count; i++) {
    struct Friction *friction = &switches->frictions[i];
    if (friction->plane.axis == NO_PLANE)
      friction->share = new_mode(reader, reader->model->constraints.items[friction->constraint].name, "share");
  }
  for (size_t i = 0; i < switches->contact_count; i++) {
    struct Contact *contact = &switches->contacts[i];
    contact->carried = new_mode(reader, reader->model->constraints.items[contact->constraint].name, "carried");
  }
}

void number_modes(struct Reader *reader) {
  struct Graph *graph = reader->model->graph;
  struct Switches *switches = &reader->model->switches;
  declare_carried_forces(reader);
  switches->first = reader->model->parameters.count;
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == MODE) graph->symbols[i].index += (int)switches->first;
}

/* --- Contacts --- */

/* Sets the constraint -gap = 0 of a contact, which applies while it is closed. Its force is positive under pressure. */
static void set_contact(struct Reader *reader, xmlNodePtr node, size_t number, Node gap) {
  struct Model *model = reader->model;
  struct Contact *contact = &model->switches.contacts[number];
  struct Variable *constraint = &model->constraints.items[contact->constraint];
  struct Quantity restitution = {.node = ZERO};
  if (expression_attribute(reader, node, "restitution", IN_CONDITION, &restitution))
    require_unit(reader, line_of_attribute(node, "restitution"), "the restitution", restitution, dimension_one);
  double value = graph_is_constant(model->graph, restitution.node) ? graph_value(model->graph, restitution.node) : 0.0;
  if (!(value >= 0.0 && value <= 1.0))
    report_error(reader->diagnostics, line_of_attribute(node, "restitution"),
                 "the restitution is %g; expected one from 0 to 1", value);
  contact->gap = gap;
  contact->restitution = restitution.node;
  if (!graph_depends_on(model->graph, gap, COORDINATE))
    report_error(reader->diagnostics, constraint->line,
                 "the gap of the contact '%s' contains no coordinate; expected an expression such as y - r, which is 0 "
                 "where it touches",
                 constraint->name);
  constraint->node = function(model->graph, GUARD, contact->mode, negate(model->graph, gap));
  if (reader->diagnostics->errors > 0) return;
  check_constraint(reader, constraint);
  if (contact->carried == ZERO) return;
  const struct Gradient gradient = gradient_by_kinds(model->graph, gap, KIND(COORDINATE) | KIND(TIME));
  add_virtual_work(model, contact->carried, &gradient);
}

static struct Friction *friction_of_contact(struct Reader *reader, const struct Contact *contact) {
  struct Friction *friction = reader->model->switches.frictions;
  while (friction->constraint != contact->constraint + 1) friction++;
  return friction;
}

/* Sets Coulomb friction in the tangent plane of a contact. In planar mechanisms one of the two velocities is 0. */
static void set_friction_of_contact(struct Reader *reader, xmlNodePtr node, const struct Contact *contact,
                                    const struct FrictionCoefficients *grip, const struct Slip *slip) {
  struct Friction *friction = friction_of_contact(reader, contact);
  Node pressing = whole_constraint_force(reader->model, contact->constraint);
  if (slip->along == ZERO && slip->across == ZERO)
    report_at(reader, node, "the shapes '%s' and '%s' cannot slide on each other; expected no friction",
              attribute(node, "between"), attribute(node, "and"));
  friction[0].velocity = slip->along;
  friction[1].velocity = slip->across;
  friction->sliding = friction->sliding_back = multiply(reader->model->graph, grip->friction, pressing);
  friction->stiction = friction->stiction_back = multiply(reader->model->graph, grip->stiction, pressing);
  complete_friction(reader, friction, unit_of("N"));
}

static void read_rigid_contact(struct Reader *reader, xmlNodePtr node) {
  const struct RigidContact *contacts = rigid_contacts(reader, node);
  size_t count = contacts != NULL ? count_shape_contacts(reader, node) : 0;
  struct FrictionCoefficients grip = read_grip(reader, node);
  for (size_t i = 0; i < count; i++) {
    size_t number = reader->present->number + i;
    set_contact(reader, node, number, contacts[i].gap);
    if (!has_shape_friction(node)) continue;
    set_friction_of_contact(reader, node, &reader->model->switches.contacts[number], &grip, &contacts[i].slip);
  }
}

static void read_contact_of_gap(struct Reader *reader, xmlNodePtr node) {
  struct Quantity gap = {.node = ZERO};
  expression_attribute(reader, node, "gap", IN_GAP, &gap);
  size_t number = reader->present->number;
  struct Variable *constraint = &reader->model->constraints.items[reader->model->switches.contacts[number].constraint];
  if (constraint->unit != NULL)
    require_unit(reader, line_of_attribute(node, "gap"), "the gap", gap, constraint->dimension);
  set_contact(reader, node, number, gap.node);
}

void read_contact(struct Reader *reader, xmlNodePtr node) {
  if (is_of_gap(node)) read_contact_of_gap(reader, node);
  else if (is_of_shapes(node) && is_compliant(node)) read_compliant_contact(reader, node);
  else if (is_of_shapes(node)) read_rigid_contact(reader, node);
}

void read_stop(struct Reader *reader, xmlNodePtr node) {
  struct Graph *graph = reader->model->graph;
  char *name = reference_attribute(reader, node, "coordinate");
  const struct Symbol *symbol = name != NULL ? find_coordinate(reader, name) : NULL;
  if (symbol == NULL)
    report_at(reader, node, "'%s' of <stop> is not a coordinate; expected the name of one", name != NULL ? name : "");
  static const char *const ends[] = {"min", "max"};
  size_t number = reader->present->number;
  bool is_declared = number < reader->model->switches.contact_count; /* else its coordinate had no valid name */
  Node room = ZERO;                                                  /* max - min */
  for (int end = 0; end < 2 && symbol != NULL && is_declared; end++) {
    struct Quantity limit;
    if (!expression_attribute(reader, node, ends[end], IN_GAP, &limit)) continue;
    const struct Variable *coordinate = &reader->model->coordinates.items[symbol->index];
    if (coordinate->dimension.known)
      require_unit(reader, line_of_attribute(node, ends[end]), ends[end], limit, coordinate->dimension);
    struct Switches *switches = &reader->model->switches;
    struct Variable *constraint = &reader->model->constraints.items[switches->contacts[number].constraint];
    constraint->dimension = coordinate->dimension;
    scope_set_dimension(reader->scope, constraint_force_name(constraint), constraint_force_dimension(constraint));
    room = end == 0 ? negate(graph, limit.node) : add(graph, room, limit.node);
    Node way = subtract(graph, symbol->node, limit.node);
    set_contact(reader, node, number++, end == 0 ? way : negate(graph, way));
  }
  bool is_fixed = !graph_depends_on(graph, room, COORDINATE) && !graph_depends_on(graph, room, MODE);
  if (has_attribute(node, "min") && has_attribute(node, "max") && is_fixed)
    expect_not_negative(reader, node, format_text("max - min of the <stop> of '%s'", name), room, true);
}

/* --- Branches --- */

void undisplace_branches(struct Reader *reader) {
  struct Graph *graph = reader->model->graph;
  struct Switches *switches = &reader->model->switches;
  for (size_t i = 0; i < switches->branch_count; i++) {
    struct Branch *branch = &switches->branches[i];
    if (!graph_depends_on(graph, branch->indicator, DISPLACEMENT)) continue;
    branch->indicator = without_displacements(reader, branch->line, branch->function, branch->indicator);
    if (simplify_fraction(graph, branch->indicator) == ZERO)
      report_error(
          reader->diagnostics, branch->line,
          "%s has a kink where the displacements are 0, so that the force of reaction is undefined; expected the kink "
          "elsewhere",
          branch->function);
  }
}
