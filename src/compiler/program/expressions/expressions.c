#include "program/expressions/expressions.h"

#include <math.h>

#include "algebra/differentiate.h"
#include "algebra/kinks.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "program/expressions/accelerations.h"
#include "program/expressions/jacobian.h"

/* Sets the seeds of modes, whose start values are knowns of initialization mode. Modes are stored with parameters. */
static void create_mode_seeds(const struct Model *model, Node *seeds) {
  struct Graph *graph = model->graph;
  for (size_t i = 0; i < model->modes.count; i++) {
    const struct Symbol *mode = graph_symbol_of(graph, model->modes.items[i].node);
    size_t symbol = graph->vertices[model->modes.items[i].node].left;
    seeds[symbol] = graph_symbol(graph, SEED_PARAMETER, mode->index, format_text("d %s", mode->name));
  }
}

/* Returns a seed symbol for each of the graph's symbols, in their order; ZERO if results cannot depend on it. */
static Node *create_seeds(const struct Model *model) {
  struct Graph *graph = model->graph;
  static const enum SymbolKind seed_kinds[] = {
      [PARAMETER] = SEED_PARAMETER,       [TIME] = SEED_TIME,   [COORDINATE] = SEED_COORDINATE,
      [VELOCITY] = SEED_VELOCITY,         [STATE] = SEED_STATE, [INPUT] = SEED_INPUT,
      [ACCELERATION] = SEED_ACCELERATION,
  };
  size_t count = graph->symbol_count;
  Node *seeds = allocate(2 * count, sizeof *seeds);
  for (size_t i = 0; i < count; i++) {
    enum SymbolKind kind = graph->symbols[i].kind;
    if (kind == DISPLACEMENT || kind == REACTION || kind == MODE || kind == DUMMY)
      continue; /* these are zero, replaced, constant along a direction, and eliminated */
    seeds[i] =
        graph_symbol(graph, seed_kinds[kind], graph->symbols[i].index, format_text("d %s", graph->symbols[i].name));
  }
  create_mode_seeds(model, seeds);
  return seeds;
}

/*
 * Forward mode through the implicit equations R = M a - b = 0: along a direction, M da = -dR at constant a. Explicit
 * accelerations are differentiated directly. result holds da; in blocks that are factored at run time, the right side
 * -dR. Costs one forward sweep and one solution. A. Griewank, A. Walther: Evaluating Derivatives, 2nd ed., 2008,
 * section 3.1.
 */
static void accelerations_along(struct Graph *graph, const struct Equations *equations, const Node *seeds,
                                Node *result) {
  size_t n = equations->explicit_form ? equations->count : row_count(equations);
  derivative_along(graph, equations->explicit_form ? equations->acceleration : equations->residual, n, seeds, result);
  if (equations->explicit_form) return;
  Node *right = allocate(n, sizeof *right);
  for (size_t i = 0; i < n; i++) right[i] = negate(graph, result[i]);
  inertia_solve(graph, equations->inertia, right, result);
  for (size_t i = 0; i < n; i++)
    if (is_looped(equations, i)) result[i] = right[i];
}

/* Solves a kinematic tree; replaces the right sides of its coordinates by the solution. */
static void solve_tree(struct Graph *graph, const struct Equations *equations, const struct InertiaBlock *block,
                       Node *right_side) {
  Node *x = allocate(block->count, sizeof *x);
  for (size_t i = 0; i < block->count; i++) x[i] = right_side[block->coordinates[i]];
  block_solve(graph, block, x);
  for (size_t i = 0; i < block->count; i++)
    if (block->coordinates[i] < equations->count) right_side[block->coordinates[i]] = x[i];
}

static void solve_trees(struct Graph *graph, const struct Equations *equations, struct Corrections *corrections) {
  const struct Inertia *inertia = equations->inertia;
  corrections->pivot = allocate(equations->constraints->count, sizeof(Node));
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    if (block->tree == NULL || block->constraint_count == 0) continue;
    solve_tree(graph, equations, block, corrections->position);
    solve_tree(graph, equations, block, corrections->velocity);
    for (size_t i = 0; i < block->count; i++)
      if (block->coordinates[i] >= equations->count)
        corrections->pivot[block->coordinates[i] - equations->count] = articulated_pivot(block->tree, i);
  }
}

/*
 * Right sides of K (change; forces) = (-M moved; -constraint), where moved is the sum of the changes. In the limit the
 * constraints hold and M moved + J^T forces = 0: the nearest point in the metric of M.
 */
static void create_corrections(struct Expressions *expressions, const Node *seeds) {
  const struct Model *model = expressions->model;
  const struct Equations *equations = expressions->equations;
  struct Graph *graph = model->graph;
  size_t n = equations->count, rows = row_count(equations);
  const struct Constraints *constraints = equations->constraints;
  struct Corrections *corrections = &expressions->corrections;
  corrections->position = allocate(rows, sizeof(Node));
  corrections->velocity = allocate(rows, sizeof(Node));
  corrections->slope = constraint_slopes(graph, constraints);
  Node *moved = allocate(rows, sizeof *moved);
  for (size_t i = 0; i < n; i++) moved[i] = replacement_of(graph, seeds, model->coordinates.items[i].node);
  inertia_add_product(graph, equations->inertia, moved, corrections->position);
  for (size_t i = 0; i < n; i++) corrections->position[i] = negate(graph, corrections->position[i]);
  for (size_t j = 0; j < constraints->count; j++) {
    corrections->position[n + j] = negate(graph, constraints->position[j]);
    corrections->velocity[n + j] = negate(graph, constraints->velocity[j]);
  }
  solve_trees(graph, equations, corrections);
}

/* Adds the generalized impulse of an impulse seed along the gradient of a gap, or of a velocity. */
static void add_impulse(const struct Model *model, Node along, enum SymbolKind kind, Node seed, Node *impulse) {
  struct Graph *graph = model->graph;
  struct Gradient gradient = gradient_by_kinds(graph, along, 1u << kind);
  for (size_t i = 0; i < gradient.count; i++) {
    size_t coordinate = (size_t)graph_symbol_of(graph, gradient.symbols[i])->index;
    if (model->prescribed.motions[coordinate].is_prescribed) continue;
    impulse[coordinate] = add(graph, impulse[coordinate], multiply(graph, seed, gradient.values[i]));
  }
}

/* Sums the generalized impulses: contacts act along their gaps, frictions along their velocities. */
static void create_impulses(struct Expressions *expressions, const Node *seeds) {
  const struct Model *model = expressions->model;
  const struct Switches *switches = &model->switches;
  Node *impulse = expressions->corrections.impulse = allocate(row_count(expressions->equations), sizeof(Node));
  for (size_t i = 0; i < switches->contact_count; i++) {
    const struct Contact *contact = &switches->contacts[i];
    Node seed = replacement_of(model->graph, seeds, model->unknowns.forces[contact->constraint]);
    add_impulse(model, contact->gap, COORDINATE, seed, impulse);
  }
  for (size_t i = 0; i < switches->friction_count && switches->contact_count > 0; i++) {
    const struct Friction *friction = &switches->frictions[i];
    Node seed = replacement_of(model->graph, seeds, model->unknowns.forces[friction->constraint]);
    add_impulse(model, friction->velocity, VELOCITY, seed, impulse);
  }
}

static void without_accelerations(const struct Graph *graph, Node *seeds) {
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == ACCELERATION) seeds[i] = ZERO;
}

static void create_results(struct Expressions *expressions, const Node *seeds) {
  const struct Interface *interface = expressions->interface;
  struct NodeList outputs = {0};
  expressions->result = allocate(interface->result_count, sizeof(Node));
  expressions->result_along = allocate(interface->result_count, sizeof(Node));
  for (size_t i = 0; i < interface->count; i++) {
    const struct InterfaceVariable *variable = &interface->variables[i];
    if (variable->entry.kind != VARIABLE_RESULT) continue;
    expressions->result[variable->entry.index] = variable->node;
    if (is_unknown(&variable->entry)) append_node(&outputs, variable->node);
  }
  Node *along = allocate(outputs.count, sizeof *along);
  derivative_along(expressions->model->graph, outputs.nodes, outputs.count, seeds, along);
  size_t next = 0;
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    if (entry->kind == VARIABLE_RESULT && is_unknown(entry)) expressions->result_along[entry->index] = along[next++];
  }
}

static void create_initial(struct Expressions *expressions, const Node *seeds) {
  const struct Interface *interface = expressions->interface;
  struct NodeList *initial = &expressions->initial;
  for (size_t i = 0; i < interface->count; i++)
    if (has_following_start(&interface->variables[i].entry)) append_node(initial, interface->variables[i].start);
  expressions->initial_along = allocate(initial->count, sizeof(Node));
  derivative_along(expressions->model->graph, initial->nodes, initial->count, seeds, expressions->initial_along);
}

/* Rates of first-order states, and their derivatives, may depend on accelerations and forces found at run time. */
static void create_rates(struct Expressions *expressions, const Node *seeds) {
  const struct Model *model = expressions->model;
  const struct NodeList *rates = &expressions->equations->rates;
  size_t rows = expressions->equations->count + model->constraints.count;
  expressions->unknowns = allocate(rows, sizeof(Node));
  expressions->unknowns_along = allocate(rows, sizeof(Node));
  for (size_t i = 0; i < rows; i++) {
    expressions->unknowns[i] = unknown_of_row(model, i);
    expressions->unknowns_along[i] = replacement_of(model->graph, seeds, expressions->unknowns[i]);
  }
  expressions->rates_along = allocate(rates->count, sizeof(Node));
  derivative_along(model->graph, rates->nodes, rates->count, seeds, expressions->rates_along);
}

static void create_directional(struct Expressions *expressions, struct OptionalParts extras) {
  struct Graph *graph = expressions->model->graph;
  Node *seeds = create_seeds(expressions->model);
  create_results(expressions, seeds);
  create_initial(expressions, seeds);
  if (expressions->equations->constraints->count > 0) create_corrections(expressions, seeds);
  if (expressions->equations->constraints->count > 0) create_impulses(expressions, seeds);
  if (extras.adjoint)
    expressions->weighted_gradient = weighted_gradient_create(expressions->model, expressions->equations,
                                                              expressions->interface, expressions->result, seeds);
  create_rates(expressions, seeds);
  without_accelerations(graph, seeds);
  expressions->along = allocate(row_count(expressions->equations), sizeof(Node));
  accelerations_along(graph, expressions->equations, seeds, expressions->along);
  const struct Elements *jacobian = &expressions->equations->constraints->jacobian;
  expressions->constraints_along = allocate(jacobian->count, sizeof(Node));
  derivative_along(graph, jacobian->nodes, jacobian->count, seeds, expressions->constraints_along);
}

static void create_linear(struct Expressions *expressions, struct Diagnostics *diagnostics) {
  const struct Model *model = expressions->model;
  if (!isnan(model->solver.max_step) || !isnan(model->solver.max_steps))
    report_error(diagnostics, model->solver.line,
                 "the method 'exact' takes a communication step as a whole; expected no maxStep%s",
                 isnan(model->solver.max_step) ? "s" : "");
  if (expressions->equations->constraints->count > 0)
    report_error(diagnostics, model->solver.line,
                 "the method 'exact' does not support constraints; expected another method, or a <linearization>");
  const struct SwitchingExpressions *switching = expressions->equations->switching;
  size_t samples = switching != NULL ? switching->sample_count : 0;
  if (switching != NULL && (switching->indicator_count > samples || model->switches.event_count > samples))
    report_error(diagnostics, model->solver.line,
                 "the method 'exact' supports no events but those of <sample>; expected another method");
  expressions->linear = linear_system_of(model, expressions->equations, diagnostics);
}

static void create_jacobian(struct Expressions *expressions, struct Diagnostics *diagnostics) {
  const struct Model *model = expressions->model;
  expressions->jacobian = jacobian_create(model->graph, expressions->equations);
  if (expressions->jacobian == NULL)
    report_error(
        diagnostics, model->solver.line,
        "the Jacobian matrix of the method '%s' would have more than %d elements, as the mass matrix couples the "
        "coordinates; expected the method 'taylor', or a smaller system",
        expressions->equations->method->name, JACOBIAN_LIMIT);
  else if (expressions->equations->method->factors)
    expressions->jacobian->factors =
        lu_pattern_create(model->graph, expressions->jacobian, expressions->equations->count,
                          expressions->equations->count + expressions->equations->rates.count);
}

/* Other methods than Taylor's take the first terms only, for the limits of their steps. */
static void create_series(struct Expressions *expressions, struct Diagnostics *diagnostics) {
  const struct Model *model = expressions->model;
  const struct Equations *equations = expressions->equations;
  const char *kink = kink_without_series_of(model->graph, equations->residual, row_count(equations));
  bool is_taylor = expressions->equations->method->series == ALL_TERMS;
  if (kink == NULL || !is_taylor) expressions->series = series_plan_of_motion(model->graph, equations);
  else
    report_error(diagnostics, model->solver.line,
                 "%s has a kink, where a Taylor series ends; expected the method 'erk'", kink);
}

static void create_output_series(struct Expressions *expressions) {
  const struct Model *model = expressions->model;
  size_t count = model->outputs.count;
  if (count == 0 || expressions->interface->output_derivative_order == 1) return;
  expressions->output_series = series_plan_of_outputs(model->graph, expressions->result, count);
}

/* Skips expressions with a kink that has no series; they need no limit. */
static void create_watched_series(struct Expressions *expressions) {
  const struct SwitchingExpressions *switching = expressions->equations->switching;
  struct Graph *graph = expressions->model->graph;
  if (switching == NULL) return;
  struct NodeList watched = {0};
  bool have_series = kink_without_series_of(graph, switching->watched, switching->watched_count) == NULL;
  for (size_t i = 0; i < switching->watched_count; i++)
    if (have_series || kink_without_series_of(graph, &switching->watched[i], 1) == NULL)
      append_node(&watched, switching->watched[i]);
  expressions->watched_series = series_plan_of_outputs(graph, watched.nodes, watched.count);
}

struct Expressions *expressions_create(const struct Model *model, const struct Equations *equations,
                                       const struct Interface *interface, struct OptionalParts extras,
                                       struct Diagnostics *diagnostics) {
  int errors = diagnostics->errors;
  const struct Method *method = equations->method;
  struct Expressions *expressions = allocate(1, sizeof *expressions);
  *expressions = (struct Expressions){.model = model, .equations = equations, .interface = interface};
  if (method != NULL && method->needs_linear) create_linear(expressions, diagnostics);
  create_directional(expressions, extras);
  if (method != NULL && method->needs_jacobian) create_jacobian(expressions, diagnostics);
  if (method != NULL && method->series != NO_SERIES) create_series(expressions, diagnostics);
  create_output_series(expressions);
  create_watched_series(expressions);
  if (graph_limit(model->graph) != NULL)
    report_error(diagnostics, 0, "the generated code needs %s; expected a smaller system", graph_limit(model->graph));
  return diagnostics->errors == errors ? expressions : NULL;
}

struct NodeList expressions_targets(const struct Expressions *expressions) {
  const struct Equations *equations = expressions->equations;
  struct NodeList targets = accelerations_targets(expressions->model->graph, equations, true);
  append_nodes(&targets, expressions->along, row_count(equations));
  if (equations->constraints->count > 0) {
    append_nodes(&targets, expressions->constraints_along, equations->constraints->jacobian.count);
    append_nodes(&targets, expressions->corrections.position, row_count(equations));
    append_nodes(&targets, expressions->corrections.velocity, row_count(equations));
    append_nodes(&targets, expressions->corrections.pivot, equations->constraints->count);
    append_nodes(&targets, expressions->corrections.slope, equations->constraints->count);
    append_nodes(&targets, expressions->corrections.impulse, equations->count);
  }
  append_nodes(&targets, equations->rates.nodes, equations->rates.count);
  append_nodes(&targets, expressions->rates_along, equations->rates.count);
  if (expressions->jacobian != NULL && expressions->jacobian->value != NULL) {
    const struct JacobianExpressions *jacobian = expressions->jacobian;
    append_nodes(&targets, jacobian->value, jacobian->count);
    for (size_t i = 0; i < jacobian->right_side_count; i++) append_node(&targets, jacobian->right_sides[i].value);
  }
  if (expressions->linear != NULL) {
    const struct LinearSystem *linear = expressions->linear;
    append_nodes(&targets, linear->a, linear->states * linear->states);
    append_nodes(&targets, linear->b, linear->states * linear->inputs);
    append_nodes(&targets, linear->c, linear->states);
  }
  if (expressions->weighted_gradient != NULL) {
    const struct WeightedGradient *gradient = expressions->weighted_gradient;
    append_nodes(&targets, gradient->elements, gradient->count);
    append_nodes(&targets, gradient->right_side, row_count(equations));
  }
  append_nodes(&targets, expressions->result, expressions->interface->result_count);
  append_nodes(&targets, expressions->result_along, expressions->interface->result_count);
  const struct SwitchingExpressions *switching = expressions->equations->switching;
  if (switching != NULL) {
    append_nodes(&targets, switching->indicators, switching->indicator_count);
    append_nodes(&targets, switching->rounding_bounds, switching->indicator_count);
    append_nodes(&targets, switching->values, switching->value_count);
    append_nodes(&targets, switching->resting_sums, switching->resting_sum_count);
    append_nodes(&targets, switching->ball_distances, expressions->model->switches.ball_count);
  }
  const struct SeriesPlan *const plans[] = {expressions->series, expressions->output_series,
                                            expressions->watched_series};
  for (int i = 0; i < 3; i++)
    if (plans[i] != NULL) append_nodes(&targets, plans[i]->targets.nodes, plans[i]->targets.count);
  return targets;
}
