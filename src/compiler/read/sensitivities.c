/*
 * Variational equations. With the accelerations a(q, v, z, p, t) as expressions, the sensitivity s = d q / d p of the
 * coordinates q obeys
 *
 *   s'' = (d a / d q) s + (d a / d v) s' + (d a / d z) r + d a / d p,
 *
 * where z are further states with z' = f, and r = d z / d p obeys the same equation with f and r' on the left. Each
 * right-hand side is one directional derivative (forward mode) of the expressions, along the direction of the
 * neighbouring motion. Each name adds expressions of about the size of the equations.
 *
 * E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd edition, 1993, section I.14.
 */
#include "read/sensitivities.h"

#include <string.h>

#include "algebra/differentiate.h"
#include "base/memory.h"
#include "read/context/variables.h"

/* Returns the variable of this name if sensitivities with respect to it exist; NULL otherwise. */
static const struct Variable *find(const struct Model *model, const char *name) {
  const struct VariableList *const lists[] = {&model->parameters, &model->inputs, &model->coordinates,
                                              &model->velocities, &model->states};
  for (size_t k = 0; k < 5; k++)
    for (size_t i = 0; i < lists[k]->count; i++)
      if (lists[k]->items[i].type == TYPE_REAL && !lists[k]->items[i].is_work &&
          strcmp(lists[k]->items[i].name, name) == 0)
        return &lists[k]->items[i];
  return NULL;
}

/* Returns the variable for the derivative of a variable with respect to another one. */
static struct Variable derivative_of(const struct Model *model, const struct Variable *of, const struct Variable *by) {
  struct Variable derivative = variable_create(format_text("%s.by.%s", of->name, by->name),
                                               format_text("derivative of %s by %s", of->name, by->name), of->line);
  derivative.dimension = dimension_multiply(of->dimension, by->dimension, -1.0);
  derivative.start = of->node == by->node ? 1.0 : 0.0;
  derivative.start_expression = graph_constant(model->graph, derivative.start);
  return derivative;
}

/* Appends the sensitivity of a coordinate and its velocity, without acceleration. reaction: index of its force. */
static void append_coordinate(struct Model *model, size_t of, const struct Variable *by, size_t reaction) {
  struct Graph *graph = model->graph;
  struct Variable position = derivative_of(model, &model->coordinates.items[of], by);
  struct Variable velocity = derivative_of(model, &model->velocities.items[of], by);
  size_t index = model->coordinates.count;
  position.node = graph_symbol(graph, COORDINATE, (int)index, position.name);
  velocity.node = graph_symbol(graph, VELOCITY, (int)index, velocity.name);
  append_variable(&model->coordinates, position);
  append_variable(&model->velocities, velocity);
  model->sensitivity_count++;
  model->unknowns.accelerations[index] =
      graph_symbol(graph, ACCELERATION, (int)index, format_text("der(%s)", velocity.name));
  model->prescribed.motions[index] = (struct PrescribedMotion){.is_prescribed = true, .reaction = reaction};
}

/* Appends the sensitivity of a state. Its rate is set later. */
static void append_state(struct Model *model, size_t of, const struct Variable *by) {
  struct Variable state = derivative_of(model, &model->states.items[of], by);
  state.is_work = model->states.items[of].is_work;
  state.node = graph_symbol(model->graph, STATE, (int)model->states.count, state.name);
  append_variable(&model->states, state);
  model->state_sensitivity_count++;
}

/*
 * Returns the direction of a neighbouring motion, one node per symbol. count, state_count: of the original coordinates
 * and states. first, first_state: indices of the sensitivities with respect to this variable.
 */
static Node *direction_of(const struct Model *model, const struct Variable *by, size_t count, size_t first,
                          size_t state_count, size_t first_state) {
  const struct Graph *graph = model->graph;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[by->node].left] = ONE;
  for (size_t i = 0; i < count; i++) {
    seeds[graph->vertices[model->coordinates.items[i].node].left] = model->coordinates.items[first + i].node;
    seeds[graph->vertices[model->velocities.items[i].node].left] = model->velocities.items[first + i].node;
    seeds[graph->vertices[model->unknowns.accelerations[i]].left] = model->unknowns.accelerations[first + i];
  }
  for (size_t i = 0; i < state_count; i++)
    seeds[graph->vertices[model->states.items[i].node].left] = model->states.items[first_state + i].node;
  return seeds;
}

static void append_outputs(struct Model *model, const struct Equations *equations, size_t outputs,
                           const struct Variable *by, const Node *seeds) {
  Node *along = allocate(outputs, sizeof *along);
  derivative_along(model->graph, equations->outputs, outputs, seeds, along);
  for (size_t i = 0; i < outputs; i++) {
    struct Variable output = derivative_of(model, &model->outputs.items[i], by);
    output.node = along[i];
    output.start_expression = ZERO;
    if (model->outputs.items[i].type == TYPE_REAL) append_variable(&model->outputs, output);
  }
}

static const char *reason_unsupported(const struct Model *model, const struct Equations *equations) {
  if (equations->explicit_form) return "linearizations";
  if (model->mechanism.regularization_count > 0) return "coordinates without mass";
  return NULL;
}

/* Moves the indices of constraint forces after those of all accelerations. */
static void number_forces(struct Model *model, size_t total) {
  struct Graph *graph = model->graph;
  for (size_t j = 0; j < model->constraints.count; j++)
    graph->symbols[graph->vertices[model->unknowns.forces[j]].left].index = (int)(total + j);
}

/* Appends the reaction of prescribed accelerations, which is 0 for all sensitivities. Returns its index. */
static size_t append_reaction(struct Model *model) {
  struct Variable reaction = variable_create(copy_text("variations.force"), NULL, 0);
  reaction.node = graph_symbol(model->graph, REACTION, (int)model->reactions.count, reaction.name);
  append_variable(&model->reactions, reaction);
  return model->reactions.count - 1;
}

static void make_room_for(struct Model *model, size_t total) {
  model->unknowns.accelerations = reallocate(model->unknowns.accelerations, total, sizeof(Node));
  model->prescribed.motions = reallocate(model->prescribed.motions, total, sizeof *model->prescribed.motions);
  struct Quantity *along = allocate(total, sizeof *along);
  memcpy(along, model->forces.along, model->coordinates.count * sizeof *along);
  model->forces.along = along;
}

static void add_sensitivity(struct Model *model, const struct Equations *equations, struct Variable by, size_t outputs,
                            size_t reaction) {
  size_t count = equations->count, first = model->coordinates.count, rows = row_count(equations);
  size_t states = equations->rates.count, first_state = model->states.count;
  for (size_t i = 0; i < count; i++) append_coordinate(model, i, &by, reaction);
  for (size_t i = 0; i < states; i++) append_state(model, i, &by);
  Node *seeds = direction_of(model, &by, count, first, states, first_state), *along = allocate(rows, sizeof *along);
  derivative_along(model->graph, equations->acceleration, rows, seeds, along);
  for (size_t i = 0; i < count; i++) model->prescribed.motions[first + i].acceleration = along[i];
  for (size_t j = count; j < rows; j++)
    seeds[model->graph->vertices[model->unknowns.forces[j - count]].left] = along[j];
  append_outputs(model, equations, outputs, &by, seeds);
  Node *rates_along = allocate(states, sizeof *rates_along);
  derivative_along(model->graph, equations->rates.nodes, states, seeds, rates_along);
  for (size_t i = 0; i < states; i++) model->states.items[first_state + i].rate = rates_along[i];
}

void add_sensitivities(struct Model *model, const struct Equations *equations, const char *const *names, size_t count,
                       struct Diagnostics *diagnostics) {
  const char *reason = reason_unsupported(model, equations);
  if (reason != NULL)
    report_error(diagnostics, 0, "--along does not support %s; expected a system without them", reason);
  for (size_t k = 0; k < count; k++) {
    if (find(model, names[k]) == NULL)
      report_error(diagnostics, 0,
                   "--along %s is not the name of a variable; expected a parameter, an input, a coordinate, a velocity "
                   "or a state",
                   names[k]);
    for (size_t j = 0; j < k; j++)
      if (strcmp(names[j], names[k]) == 0)
        report_error(diagnostics, 0, "--along %s is given twice; expected it once", names[k]);
  }
  if (diagnostics->errors > 0) return;
  size_t outputs = model->outputs.count, reaction = append_reaction(model);
  make_room_for(model, (count + 1) * equations->count);
  number_forces(model, (count + 1) * equations->count);
  for (size_t k = 0; k < count; k++) add_sensitivity(model, equations, *find(model, names[k]), outputs, reaction);
}
