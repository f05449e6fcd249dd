#include "interface/listing.h"

#include <math.h>
#include <string.h>

#include "algebra/kinks.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "interface/symbol_names.h"
#include "mechanics/energies.h"
#include "mechanics/switching.h"

static struct InterfaceVariable *append(struct Interface *interface, enum VariableKind kind, size_t index,
                                        const char *name, const char *description) {
  interface->variables = make_room(interface->variables, interface->count, sizeof *interface->variables);
  if (index == 0) interface->first[kind] = interface->count;
  struct InterfaceVariable *variable = &interface->variables[interface->count++];
  *variable = (struct InterfaceVariable){
      .entry = {.name = name, .kind = kind, .index = index, .start = NAN, .minimum = NAN, .maximum = NAN},
      .description = description,
      .nominal = NAN};
  return variable;
}

static void set_units(struct InterfaceVariable *variable, const struct Variable *source) {
  variable->unit = variable_unit(source);
  if (source->display_unit != NULL && variable->unit != NULL) variable->display_unit = source->display_unit;
}

/* Returns the names of the symbols below the node. */
static char *names_below(const struct Model *model, Node node) {
  struct SymbolNames names = {0};
  symbol_names_add(&names, model->graph, &node, 1);
  return symbol_names_text(&names, model->graph);
}

/* Sets the expression of a start value that follows from parameters. */
static void follow_start(struct InterfaceVariable *variable, const struct Model *model, const struct Variable *source) {
  if (!start_follows(model, source)) return;
  variable->start = source->start_expression;
  variable->entry.follows_from = names_below(model, source->start_expression);
}

static void append_list(struct Interface *interface, const struct Model *model, const struct VariableList *list,
                        enum VariableKind kind, size_t first_index) {
  for (size_t i = 0; i < list->count; i++) {
    const struct Variable *source = &list->items[i];
    struct InterfaceVariable *variable = append(interface, kind, first_index + i, source->name, source->description);
    variable->entry.is_output = kind == VARIABLE_STATE || kind == VARIABLE_RESULT;
    variable->entry.type = source->type;
    variable->entry.start = source->start;
    variable->entry.minimum = source->minimum;
    variable->entry.maximum = source->maximum;
    set_units(variable, source);
    variable->nominal = source->nominal;
    variable->node = source->node;
    follow_start(variable, model, source);
  }
}

static struct InterfaceVariable *append_result(struct Interface *interface, const char *name, const char *unit,
                                               Node node, const char *description) {
  struct InterfaceVariable *variable = append(interface, VARIABLE_RESULT, interface->result_count++, name, description);
  variable->unit = unit;
  variable->node = node;
  return variable;
}

/* Appends calculated parameters as results, which are computed when read. */
static void append_calculated(struct Interface *interface, const struct Model *model) {
  for (size_t i = 0; i < model->calculated.count; i++) {
    const struct Variable *source = &model->calculated.items[i];
    struct InterfaceVariable *variable =
        append_result(interface, source->name, NULL, source->node, source->description);
    variable->entry.follows_from = names_below(model, source->node);
    set_units(variable, source);
  }
}

/* Returns a unit; NULL if FMI cannot express the dimension. */
static char *unit_of_dimension(struct Dimension dimension) {
  return dimension_is_whole(dimension) ? unit_text(dimension) : NULL;
}

static void append_derivative(struct Interface *interface, const struct Variable *state, size_t index, Node node) {
  char *name = format_text("der(%s)", state->name), *text = format_text("time derivative of %s", state->name);
  struct InterfaceVariable *variable = append(interface, VARIABLE_DERIVATIVE, index, name, text);
  variable->node = node;
  variable->unit = unit_of_dimension(dimension_multiply(state->dimension, unit_of("s"), -1.0));
}

/* True if both are components of one vector, and both or neither depend on accelerations, which may be unavailable. */
static bool belong_together(const struct Graph *graph, const struct InterfaceVariable *a,
                            const struct InterfaceVariable *b) {
  const char *end = strrchr(a->entry.name, '.');
  return end != NULL && strncmp(a->entry.name, b->entry.name, (size_t)(end - a->entry.name) + 1) == 0 &&
         graph_depends_on(graph, a->node, ACCELERATION) == graph_depends_on(graph, b->node, ACCELERATION);
}

static void append_element_variables(struct Interface *interface, const struct Model *model,
                                     const struct Equations *equations) {
  for (size_t i = 0; i < model->mechanism.element_variables.count; i++) {
    const struct Variable *source = &model->mechanism.element_variables.items[i];
    struct InterfaceVariable *variable =
        append_result(interface, source->name, source->unit, equations->element_variables[i], source->description);
    variable->is_continued = i > 0 && belong_together(model->graph, variable - 1, variable);
  }
}

/* Returns N or N.m for forces and torques, base units for other generalized forces. */
static const char *unit_of_force(struct Dimension dimension) {
  static const char *const names[] = {"N", "N.m"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (dimension.known && dimension_agrees(dimension, unit_of(names[i]))) return names[i];
  return unit_of_dimension(dimension);
}

static void append_reactions(struct Interface *interface, const struct Model *model,
                             const struct Equations *equations) {
  for (size_t i = 0; i < model->reactions.count; i++) {
    const struct Variable *source = &model->reactions.items[i];
    append_result(interface, source->name, unit_of_force(source->dimension), equations->reactions[i],
                  source->description);
  }
}

/* Returns the force at a constraint's index, with what acts beside it: sliding forces, and forces that contacts carry. */
static Node whole_force(const struct Model *model, size_t constraint, Node force) {
  for (size_t i = 0; i < model->switches.friction_count; i++)
    if (model->switches.frictions[i].constraint == constraint)
      return friction_force(model->graph, &model->switches.frictions[i], force);
  return add(model->graph, force, carried_force(model, constraint));
}

/* Appends the constraint forces. Force times constraint is an energy, or a power for constraints of velocities. */
static void append_constraint_forces(struct Interface *interface, const struct Model *model,
                                     const struct Equations *equations) {
  for (size_t i = 0; i < model->constraints.count; i++) {
    const struct Variable *constraint = &model->constraints.items[i];
    const char *description = constraint->description != NULL ? constraint->description : constraint->name;
    bool is_of_joint = constraint->force_name != NULL; /* its description is that of the force */
    char *text = is_of_joint ? copy_text(description) : format_text("force of the constraint: %s", description);
    Node force = equations->explicit_form ? equations->acceleration[equations->count + i] : model->unknowns.forces[i];
    if (constraint->force_share != ZERO) force = multiply(model->graph, constraint->force_share, force);
    const char *unit = unit_of_force(constraint_force_dimension(constraint));
    append_result(interface, constraint_force_name(constraint), unit, whole_force(model, i, force), text);
  }
}

static struct InterfaceVariable *append_mode(struct Interface *interface, const struct Model *model,
                                             enum VariableKind kind, Node mode, const char *name,
                                             const char *description) {
  size_t index = (size_t)graph_symbol_of(model->graph, mode)->index;
  struct InterfaceVariable *variable = append(interface, kind, index, name, description);
  variable->node = mode;
  if (kind == VARIABLE_CONTACT) variable->entry.type = TYPE_INTEGER;
  return variable;
}

static void append_modes(struct Interface *interface, const struct Model *model) {
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < model->modes.count; i++) {
    const struct Variable *mode = &model->modes.items[i];
    struct InterfaceVariable *variable =
        append_mode(interface, model, VARIABLE_MODE, mode->node, mode->name, mode->description);
    variable->entry.start = mode->start;
    set_units(variable, mode);
    follow_start(variable, model, mode);
  }
  for (size_t i = 0; i < switches->contact_count; i++) {
    const char *constraint = model->constraints.items[switches->contacts[i].constraint].name;
    append_mode(interface, model, VARIABLE_CONTACT, switches->contacts[i].mode, format_text("%s.closed", constraint),
                "1 while it is closed, else 0");
  }
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool is_in_plane = switches->frictions[i].plane.axis != NO_PLANE;
    if (switches->frictions[i].plane.axis == ACROSS) continue; /* shares the mode of the friction along */
    char *name = format_text("%s.sliding", model->constraints.items[switches->frictions[i].constraint].name);
    append_mode(interface, model, VARIABLE_CONTACT, switches->frictions[i].reported, name,
                is_in_plane ? "1 while it slides, 0 while it sticks"
                            : "1 or -1 while it slides, by the sign of the velocity, 0 while it sticks");
  }
}

static void append_statistic(struct Interface *interface, enum Statistic statistic, const char *name,
                             const char *description) {
  append(interface, VARIABLE_STATISTIC, statistic, name, description)->entry.type = TYPE_INTEGER;
}

static void append_statistics(struct Interface *interface, const struct Model *model, const struct Method *method) {
  append_statistic(interface, STATISTIC_STEPS, "solverSteps", "steps that the solver has taken");
  if (method->evaluations != NULL)
    append_statistic(interface, STATISTIC_DERIVATIVES, "derivativeEvaluations", method->evaluations);
  if (method->needs_jacobian)
    append_statistic(interface, STATISTIC_JACOBIANS, "jacobianEvaluations", "evaluations of the Jacobian matrix");
  if (method->hands_over)
    append_statistic(interface, STATISTIC_HANDOVERS, "solverHandovers", "handovers between the methods of the solver");
  if (has_switches(&model->switches))
    append_statistic(interface, STATISTIC_EVENTS, "events", "events that changed a mode or a velocity");
}

static bool uses_time(const struct Model *model, const struct Equations *equations) {
  const struct Graph *graph = model->graph;
  bool uses = graph_depends_on(graph, equations->power, TIME) || graph_depends_on(graph, equations->total, TIME);
  for (size_t i = 0; i < equations->rates.count; i++) uses |= graph_depends_on(graph, equations->rates.nodes[i], TIME);
  for (size_t i = 0; i < row_count(equations); i++) uses |= graph_depends_on(graph, equations->residual[i], TIME);
  for (size_t i = 0; i < model->reactions.count; i++) uses |= graph_depends_on(graph, equations->reactions[i], TIME);
  for (size_t i = 0; i < model->outputs.count; i++) uses |= graph_depends_on(graph, equations->outputs[i], TIME);
  for (size_t i = 0; i < model->mechanism.element_variables.count; i++)
    uses |= graph_depends_on(graph, equations->element_variables[i], TIME);
  return uses;
}

/* True if the potential energy may jump between its pieces, or its modes depend on more than the coordinates. */
static bool steps_in_time(const struct Model *model) {
  const struct Graph *graph = model->graph;
  bool steps = false;
  if (!graph_depends_on(graph, model->energies.potential.node, MODE)) return false;
  for (size_t i = 0; i < model->switches.branch_count; i++) {
    Node indicator = model->switches.branches[i].indicator;
    const char *function = model->switches.branches[i].function;
    steps |= strcmp(function, "sign") == 0 || strcmp(function, "a condition") == 0;
    steps |= graph_depends_on(graph, indicator, TIME) || graph_depends_on(graph, indicator, VELOCITY) ||
             graph_depends_on(graph, indicator, STATE) || graph_depends_on(graph, indicator, INPUT);
  }
  return steps;
}

/*
 * Returns the description of totalEnergy, which names the conservation law if there is one, see energies.h.
 * scripts/library/sweeping reads its ending.
 */
static const char *total_energy_description(const struct Model *model) {
  const struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  bool changes = switches->contact_count + switches->event_count > 0 || model->energies.has_prescribed ||
                 model->prescribed.constraint != NULL || model->linearized ||
                 graph_depends_on(graph, model->energies.kinetic.node, TIME) ||
                 graph_depends_on(graph, model->energies.potential.node, TIME) ||
                 graph_depends_on(graph, model->energies.potential.node, STATE) || steps_in_time(model);
  bool has_work = work_of(model) != NULL;
  if (work_includes_all_forces(model)) changes = switches->contact_count + switches->event_count > 0;
  if (changes || (model->forces.any && !has_work)) return "kinetic and potential energy";
  return has_work ? "kinetic and potential energy; changes by nonConservativeWork alone"
                  : "kinetic and potential energy; constant";
}

/* Returns the highest derivative of outputs. Those above the first come from Taylor series, which end at a kink. */
static int output_derivative_order(const struct Model *model, const struct Equations *equations) {
  if (equations->method != NULL && equations->method->series == FIRST_TERMS) return 1;
  if (depend_on_constraint_force(model, equations->outputs, model->outputs.count)) return 1;
  return kink_of(model->graph, equations->outputs, model->outputs.count) == NULL ? OUTPUT_ORDER : 1;
}

/* True if a constraint of the block is permanent. Contacts are open at the start, and change nothing then. */
static bool is_constrained_at_start(const struct Model *model, const struct InertiaBlock *block) {
  bool has_constraint = false;
  for (size_t i = 0; i < block->count; i++) {
    size_t row = block->coordinates[i];
    if (row < model->coordinates.count) continue;
    has_constraint |=
        !graph_depends_on(model->graph, model->constraints.items[row - model->coordinates.count].node, MODE);
  }
  return has_constraint;
}

/* Marks the states of coordinates in permanent constraints, unless they are fixed. */
static void mark_moved_states(struct Interface *interface, const struct Model *model,
                              const struct Equations *equations) {
  size_t n = equations->count;
  for (size_t i = 0; i < 2 * n && equations->constraints->count > 0; i++) {
    struct InterfaceVariable *state = &interface->variables[interface_find(interface, VARIABLE_STATE, i)];
    state->is_moved_at_start = is_constrained_at_start(model, inertia_block_of(equations->inertia, i % n)) &&
                               !model->coordinates.items[i % n].is_fixed;
  }
}

/* True if constraints, contacts or frictions act on the coordinate, directly or through others. */
static bool is_constrained(const struct Equations *equations, size_t coordinate) {
  const struct InertiaBlock *block = inertia_block_of(equations->inertia, coordinate);
  size_t i = 0;
  while (i < block->count && block->coordinates[i] < equations->count) i++;
  return i < block->count;
}

/* Marks the states that impacts, projection or events may change. */
static void mark_reinitialized_states(struct Interface *interface, const struct Model *model,
                                      const struct Equations *equations) {
  size_t n = equations->count;
  struct InterfaceVariable *states = &interface->variables[interface->first[VARIABLE_STATE]];
  for (size_t i = 0; i < 2 * n && equations->constraints->count > 0; i++)
    states[i].entry.is_reinitialized = is_constrained(equations, i % n);
  for (size_t i = 0; i < model->switches.event_count; i++) {
    const struct Event *event = &model->switches.events[i];
    for (size_t j = 0; j < event->assignment_count; j++) {
      const struct Symbol *symbol = graph_symbol_of(model->graph, event->assignments[j].symbol);
      if (symbol->kind != MODE) states[state_slot(n, symbol)].entry.is_reinitialized = true;
    }
  }
}

/* Appends the event indicators, which FMI 2.0 has as a function only. */
static void append_indicators(struct Interface *interface, const struct SwitchingExpressions *switching) {
  for (size_t i = 0; switching != NULL && i < switching->indicator_count; i++) {
    append(interface, VARIABLE_INDICATOR, i, format_text("eventIndicator[%zu]", i + 1),
           "changes its sign where a mode may change")
        ->node = switching->indicators[i];
  }
}

static void append_time(struct Interface *interface, const struct Model *model) {
  struct InterfaceVariable *time = append(interface, VARIABLE_TIME, 0, "time", "time");
  time->unit = "s";
  time->node = model->time;
}

/* Appends the variables of systems with coordinates. */
static void append_mechanics(struct Interface *interface, const struct Model *model,
                             const struct Equations *equations) {
  append_element_variables(interface, model, equations);
  append_reactions(interface, model, equations);
  append_constraint_forces(interface, model, equations);
  append_result(interface, "kineticEnergy", "J", equations->kinetic, "kinetic energy");
  append_result(interface, "potentialEnergy", "J", equations->potential, "potential energy");
  append_result(interface, "totalEnergy", "J", equations->total, total_energy_description(model));
  mark_moved_states(interface, model, equations);
}

/* Returns the expression of an acceleration; in trees its symbol, as each expression would contain the whole tree. */
static Node acceleration_of(const struct Model *model, const struct Equations *equations, size_t i) {
  bool is_in_tree = !equations->explicit_form && inertia_block_of(equations->inertia, i)->tree != NULL;
  return is_in_tree ? model->unknowns.accelerations[i] : equations->acceleration[i];
}

/* Appends coordinates, velocities and first-order states, then the derivatives of all. */
static void append_states(struct Interface *interface, const struct Model *model, const struct Equations *equations) {
  size_t n = model->coordinates.count;
  append_list(interface, model, &model->coordinates, VARIABLE_STATE, 0);
  append_list(interface, model, &model->velocities, VARIABLE_STATE, n);
  append_list(interface, model, &model->states, VARIABLE_STATE, 2 * n);
  for (size_t i = 0; i < model->states.count; i++)
    interface->variables[interface_find(interface, VARIABLE_STATE, 2 * n + i)].entry.is_output =
        !model->states.items[i].is_work;
  for (size_t i = 0; i < n; i++)
    append_derivative(interface, &model->coordinates.items[i], i, model->velocities.items[i].node);
  for (size_t i = 0; i < n; i++)
    append_derivative(interface, &model->velocities.items[i], n + i, acceleration_of(model, equations, i));
  for (size_t i = 0; i < model->states.count; i++)
    append_derivative(interface, &model->states.items[i], 2 * n + i, equations->rates.nodes[i]);
  interface->state_count = 2 * n + model->states.count;
}

static void append_outputs(struct Interface *interface, const struct Model *model, const struct Equations *equations) {
  append_list(interface, model, &model->outputs, VARIABLE_RESULT, 0);
  for (size_t i = 0; i < model->outputs.count; i++)
    interface->variables[interface_find(interface, VARIABLE_RESULT, i)].node = equations->outputs[i];
  interface->result_count = model->outputs.count;
}

struct Interface *interface_create(const struct Model *model, const struct Equations *equations) {
  struct Interface *interface = allocate(1, sizeof *interface);
  interface->output_derivative_order = output_derivative_order(model, equations);
  interface->depends_on_time = uses_time(model, equations);
  if (interface->depends_on_time) append_time(interface, model);
  append_states(interface, model, equations);
  append_list(interface, model, &model->inputs, VARIABLE_INPUT, 0);
  append_list(interface, model, &model->parameters, VARIABLE_PARAMETER, 0);
  append_modes(interface, model);
  append_outputs(interface, model, equations);
  append_calculated(interface, model);
  if (model->coordinates.count > 0) append_mechanics(interface, model, equations);
  mark_reinitialized_states(interface, model, equations);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].entry.kind == VARIABLE_RESULT)
      interface->variables[i].node = without_branches(model, interface->variables[i].node);
  if (!is_motionless(model)) append_statistics(interface, model, equations->method);
  interface->count_in_fmi2 = interface->count;
  append_indicators(interface, equations->switching);
  if (!interface->depends_on_time) append_time(interface, model);
  return interface;
}
