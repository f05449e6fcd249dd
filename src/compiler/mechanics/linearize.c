#include "mechanics/linearize.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "algebra/formula.h"
#include "algebra/node_list.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/* Expansion of the variables at the operating point: states, inputs, accelerations and constraint forces. */
struct LinearizationSeries {
  struct Graph *graph;
  Node *values;     /* of each symbol: its value at the point; parameters stay */
  Node *deviations; /* of each symbol: symbol - value; ZERO for parameters */
};

enum {
  STATES_AND_INPUTS = 1u << COORDINATE | 1u << VELOCITY | 1u << STATE | 1u << INPUT,
  EXPANDED = STATES_AND_INPUTS | 1u << ACCELERATION,
};

static Node at_point(const struct LinearizationSeries *expansion, Node node) {
  Node value;
  substitute(expansion->graph, &node, 1, expansion->values, &value);
  return value;
}

static Node deviation_of(const struct LinearizationSeries *expansion, Node symbol) {
  return expansion->deviations[expansion->graph->vertices[symbol].left];
}

static void set_value(struct LinearizationSeries *expansion, Node symbol, Node value) {
  Node number = expansion->graph->vertices[symbol].left;
  expansion->values[number] = value;
  expansion->deviations[number] = subtract(expansion->graph, symbol, value);
}

static Node point_of(const struct Model *model, Node symbol) {
  return model->point.values[model->graph->vertices[symbol].left];
}

static struct LinearizationSeries expansion_create(const struct Model *model) {
  struct Graph *graph = model->graph;
  struct LinearizationSeries expansion = {.graph = graph};
  expansion.values = own_symbols(graph);
  expansion.deviations = allocate(graph->symbol_count, sizeof(Node));
  const struct VariableList *lists[] = {&model->coordinates, &model->velocities, &model->states, &model->inputs};
  for (size_t list = 0; list < 4; list++)
    for (size_t i = 0; i < lists[list]->count; i++)
      set_value(&expansion, lists[list]->items[i].node, point_of(model, lists[list]->items[i].node));
  for (size_t i = 0; i < model->modes.count; i++) /* modes keep their start values */
    set_value(&expansion, model->modes.items[i].node, model->modes.items[i].start_expression);
  return expansion;
}

/* Returns factor * sum over symbols s of (d node / d s at the point) * deviation of s. */
static Node change_of(const struct LinearizationSeries *expansion, Node node, double factor) {
  struct Graph *graph = expansion->graph;
  struct Gradient slopes = gradient_by_kinds(graph, node, EXPANDED);
  Node change = ZERO;
  for (size_t i = 0; i < slopes.count; i++) {
    Node slope = scale(graph, factor, at_point(expansion, slopes.values[i]));
    change = add(graph, change, multiply(graph, slope, deviation_of(expansion, slopes.symbols[i])));
  }
  return change;
}

/* Returns the Taylor polynomial of degree 1 at the point. */
static Node expand(const struct LinearizationSeries *expansion, Node node) {
  Node change = change_of(expansion, node, 1.0);
  return add(expansion->graph, at_point(expansion, node), change);
}

/* Returns the Taylor polynomial of degree 2 at the point. */
static Node expand_twice(const struct LinearizationSeries *expansion, Node node) {
  struct Graph *graph = expansion->graph;
  struct Gradient slopes = gradient_by_kinds(graph, node, EXPANDED);
  Node result = at_point(expansion, node);
  for (size_t i = 0; i < slopes.count; i++) {
    Node change = change_of(expansion, slopes.values[i], 0.5);
    Node mean = add(graph, at_point(expansion, slopes.values[i]), change);
    result = add(graph, result, multiply(graph, mean, deviation_of(expansion, slopes.symbols[i])));
  }
  return result;
}

static void warn_without_equilibrium(const struct Model *model, const Node *accelerations, const Node *rates,
                                     const struct Diagnostics *diagnostics) {
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  for (size_t i = 0; i < model->coordinates.count; i++) {
    double velocity = values[point_of(model, model->velocities.items[i].node)];
    double acceleration = values[accelerations[i]];
    if (fabs(velocity) > 1e-9 || !(fabs(acceleration) < 1e-9))
      report_warning(diagnostics, 0,
                     "the operating point is not an equilibrium: %s = %g, der(%s) = %g; expected 0 for both",
                     model->velocities.items[i].name, velocity, model->velocities.items[i].name, acceleration);
  }
  for (size_t i = 0; i < model->states.count; i++)
    if (!(fabs(values[rates[i]]) < 1e-9))
      report_warning(diagnostics, 0, "the operating point is not an equilibrium: der(%s) = %g; expected 0",
                     model->states.items[i].name, values[rates[i]]);
}

/*
 * Solves M solution = right for a block, with several right sides by rows; in fractions if they are small enough. Rows
 * are in the block's order of elimination.
 */
static void solve_block(struct Graph *graph, const struct InertiaBlock *block, size_t columns, const Node *right,
                        Node *solution) {
  size_t n = block->count;
  Node *mass = allocate(n * n, sizeof *mass), *column = allocate(n, sizeof *column);
  for (size_t i = 0; i < n; i++)
    for (size_t k = block->start[i]; k < block->start[i + 1]; k++)
      mass[i * n + block->column[k]] = mass[block->column[k] * n + i] = block->mass[k];
  bool solved = solve_fractions(graph, n, mass, columns, right, solution);
  for (size_t j = 0; j < columns && !solved; j++) {
    for (size_t i = 0; i < n; i++) column[i] = right[i * columns + j];
    block_solve(graph, block, column);
    for (size_t i = 0; i < n; i++) solution[i * columns + j] = column[i];
  }
}

/* Computes the accelerations and constraint forces at the point. */
static void find_values(struct LinearizationSeries *expansion, const struct Model *model,
                        const struct Equations *equations, const struct Inertia *inertia, Node *value) {
  Node *right = allocate(inertia->count, sizeof *right);
  for (size_t b = 0; b < inertia->block_count; b++) {
    const struct InertiaBlock *block = &inertia->blocks[b];
    for (size_t i = 0; i < block->count; i++)
      right[i] = at_point(expansion, equations->right_side[block->coordinates[i]]);
    solve_block(expansion->graph, block, 1, right, right);
    for (size_t i = 0; i < block->count; i++) value[block->coordinates[i]] = right[i];
  }
  for (size_t i = 0; i < inertia->count; i++) set_value(expansion, unknown_of_row(model, i), value[i]);
}

/* Collects the symbols of all gradients, ascending, each once. Returns their number. */
static size_t join_symbols(const struct Gradient *gradients, size_t count, Node **symbols) {
  size_t all = 0, kept = 0;
  for (size_t i = 0; i < count; i++) all += gradients[i].count;
  *symbols = allocate(all, sizeof **symbols);
  all = 0;
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < gradients[i].count; k++) (*symbols)[all++] = gradients[i].symbols[k];
  sort_nodes(*symbols, all);
  for (size_t k = 0; k < all; k++)
    if (kept == 0 || (*symbols)[kept - 1] != (*symbols)[k]) (*symbols)[kept++] = (*symbols)[k];
  return kept;
}

/* Solves M da = -(d residual / d s) ds for a block, with M and the accelerations at the point. */
static void linearize_block(const struct LinearizationSeries *expansion, const struct Equations *equations,
                            const struct InertiaBlock *block, Node *acceleration) {
  struct Graph *graph = expansion->graph;
  struct Gradient *gradients = allocate(block->count, sizeof *gradients);
  for (size_t i = 0; i < block->count; i++)
    gradients[i] = gradient_by_kinds(graph, equations->residual[block->coordinates[i]], STATES_AND_INPUTS);
  Node *symbols;
  size_t columns = join_symbols(gradients, block->count, &symbols);
  Node *slopes = allocate(block->count * columns, sizeof *slopes);
  for (size_t i = 0; i < block->count; i++)
    for (size_t k = 0, j = 0; k < gradients[i].count; k++) {
      while (symbols[j] != gradients[i].symbols[k]) j++;
      slopes[i * columns + j] = negate(graph, at_point(expansion, gradients[i].values[k]));
    }
  solve_block(graph, block, columns, slopes, slopes);
  for (size_t i = 0; i < block->count; i++) {
    Node *sum = &acceleration[block->coordinates[i]];
    for (size_t j = 0; j < columns; j++)
      *sum = add(graph, *sum, multiply(graph, slopes[i * columns + j], deviation_of(expansion, symbols[j])));
  }
}

static bool can_be_linearized(const struct Model *model, const struct Equations *equations,
                              struct Diagnostics *diagnostics) {
  bool depends_on_time = false;
  for (size_t i = 0; i < equations->count; i++)
    depends_on_time |= graph_depends_on(model->graph, equations->residual[i], TIME);
  for (size_t i = 0; i < equations->rates.count; i++)
    depends_on_time |= graph_depends_on(model->graph, equations->rates.nodes[i], TIME);
  if (depends_on_time)
    report_error(diagnostics, 0,
                 "the equations of motion depend on time; expected a system without explicit time to linearize");
  else if (is_motionless(model))
    report_error(diagnostics, 0, "the system has no states to linearize; expected a <coordinate> or a <state>");
  return !depends_on_time && !is_motionless(model);
}

static bool is_singular(const struct Model *model, const struct Inertia *inertia, struct Diagnostics *diagnostics) {
  bool singular = false;
  for (size_t i = 0; i < inertia->coordinate_count; i++) {
    if (inertia_element(inertia, i, i) != ZERO) continue;
    report_error(diagnostics, 0,
                 "the mass matrix is singular in coordinate '%s' at the operating point; expected another point",
                 model->coordinates.items[i].name);
    singular = true;
  }
  return singular;
}

/* Replaces the unknowns from row first on by their linearized expressions. */
static Node without_unknowns(const struct Model *model, const struct Equations *linear, size_t first, Node node) {
  struct Graph *graph = model->graph;
  Node *replacements = own_symbols(graph), result;
  for (size_t i = first; i < linear->count + model->constraints.count; i++)
    replacements[graph->vertices[unknown_of_row(model, i)].left] = linear->acceleration[i];
  substitute(graph, &node, 1, replacements, &result);
  return result;
}

/* True if the point fulfils the constraints and their time derivatives. */
static bool fulfils_constraints(const struct LinearizationSeries *expansion, const struct Model *model,
                                const struct Equations *equations, struct Diagnostics *diagnostics) {
  const struct Constraints *constraints = equations->constraints;
  Node *levels = allocate(2 * constraints->count, sizeof *levels);
  for (size_t j = 0; j < constraints->count; j++) {
    levels[2 * j] = at_point(expansion, constraints->position[j]);
    levels[2 * j + 1] = at_point(expansion, constraints->velocity[j]);
  }
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  size_t wrong = 0;
  while (wrong < 2 * constraints->count && fabs(values[levels[wrong]]) < 1e-9) wrong++;
  if (wrong < 2 * constraints->count)
    report_error(diagnostics, 0,
                 "the operating point does not fulfil the constraint '%s': %s is %g at the parameters' start values; "
                 "expected a point where it is 0",
                 model->constraints.items[wrong / 2].name, wrong % 2 == 0 ? "it" : "its time derivative",
                 values[levels[wrong]]);
  return wrong == 2 * constraints->count;
}

/* Fills in the equations: affine in states and inputs, with energies of degree 2. */
static void expand_all(const struct LinearizationSeries *expansion, const struct Model *model,
                       const struct Equations *equations, struct Equations *linear) {
  struct Graph *graph = expansion->graph;
  for (size_t b = 0; b < linear->inertia->block_count; b++)
    linearize_block(expansion, equations, &linear->inertia->blocks[b], linear->acceleration);
  for (size_t i = 0; i < linear->count; i++) {
    linear->right_side[i] = linear->acceleration[i];
    linear->residual[i] = subtract(graph, model->unknowns.accelerations[i], linear->acceleration[i]);
  }
  for (size_t i = 0; i < model->reactions.count; i++)
    linear->reactions[i] = without_unknowns(model, linear, linear->count, expand(expansion, equations->reactions[i]));
  for (size_t i = 0; i < model->outputs.count; i++)
    linear->outputs[i] = without_unknowns(model, linear, linear->count, expand(expansion, equations->outputs[i]));
  for (size_t i = 0; i < model->mechanism.element_variables.count; i++)
    linear->element_variables[i] =
        without_unknowns(model, linear, linear->count, expand(expansion, equations->element_variables[i]));
  for (size_t i = 0; i < equations->rates.count; i++)
    append_node(&linear->rates, without_unknowns(model, linear, 0, expand(expansion, equations->rates.nodes[i])));
  linear->power = linear->stated_power = equations->power;
  linear->kinetic = expand_twice(expansion, equations->kinetic);
  linear->potential = expand_twice(expansion, equations->potential);
  linear->total = add(graph, linear->kinetic, linear->potential);
}

struct Equations *linearize(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics) {
  if (!can_be_linearized(model, equations, diagnostics)) return NULL;
  struct LinearizationSeries expansion = expansion_create(model);
  struct Equations *linear = equations_create(model);
  linear->explicit_form = true;
  linear->inertia = inertia_substitute(model->graph, equations->inertia, expansion.values);
  bool singular = is_singular(model, linear->inertia, diagnostics) ||
                  !fulfils_constraints(&expansion, model, equations, diagnostics);
  if (!singular) {
    find_values(&expansion, model, equations, linear->inertia, linear->acceleration);
    Node *values = allocate(row_count(linear), sizeof *values),
         *rates = allocate(equations->rates.count, sizeof *rates);
    memcpy(values, linear->acceleration, row_count(linear) * sizeof *values);
    expand_all(&expansion, model, equations, linear);
    for (size_t i = 0; i < equations->rates.count; i++) rates[i] = at_point(&expansion, linear->rates.nodes[i]);
    warn_without_equilibrium(model, values, rates, diagnostics);
    linear->constraints->count = 0; /* the linear equations satisfy them */
  }
  return singular ? NULL : linear;
}

/* Returns replacements for all symbols: 0, except for parameters, modes and time. */
static Node *zero_symbols(const struct Model *model) {
  struct Graph *graph = model->graph;
  Node *zero = allocate(graph->symbol_count, sizeof *zero);
  for (size_t i = 0; i < model->parameters.count; i++)
    zero[graph->vertices[model->parameters.items[i].node].left] = model->parameters.items[i].node;
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == MODE) zero[i] = graph->symbols[i].node;
  zero[graph->vertices[model->time].left] = model->time;
  return zero;
}

/* Fills a row of A, B and c; reports a derivative that is not linear with constant coefficients. */
static void fill_row(const struct Model *model, Node derivative, size_t row, const char *name,
                     struct LinearSystem *system, struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  struct Gradient slopes = gradient_by_kinds(graph, derivative, STATES_AND_INPUTS);
  Node *a = system->a + row * system->states, *b = system->b + row * system->inputs;
  for (size_t k = 0; k < slopes.count; k++) {
    const struct Symbol *symbol = graph_symbol_of(graph, slopes.symbols[k]);
    Node slope = simplify_fraction(graph, slopes.values[k]);
    if (symbol->kind == INPUT) b[symbol->index] = slope;
    else a[state_slot(model->coordinates.count, symbol)] = slope;
    if (!graph_is_constant_in_time(graph, slope) || graph_depends_on(graph, slope, MODE))
      report_error(diagnostics, model->solver.line,
                   "the system is not linear: der(%s) is not linear in %s; expected a method other than 'exact'", name,
                   symbol->name);
  }
  substitute(graph, &derivative, 1, zero_symbols(model), &system->c[row]);
  if (!graph_is_constant_in_time(graph, system->c[row]))
    report_error(diagnostics, model->solver.line,
                 "the system is not linear with constant coefficients: der(%s) depends on time; expected a "
                 "method other than 'exact'",
                 name);
}

struct LinearSystem *linear_system_of(const struct Model *model, const struct Equations *equations,
                                      struct Diagnostics *diagnostics) {
  size_t n = equations->count, states = 2 * n + equations->rates.count;
  struct LinearSystem *system = allocate(1, sizeof *system);
  system->states = states;
  system->inputs = model->inputs.count;
  system->a = allocate(states * states, sizeof(Node));
  system->b = allocate(states * system->inputs, sizeof(Node));
  system->c = allocate(states, sizeof(Node));
  for (size_t i = 0; i < n; i++) system->a[i * states + n + i] = ONE;
  int errors = diagnostics->errors;
  for (size_t i = 0; i < n; i++)
    fill_row(model, equations->acceleration[i], n + i, model->velocities.items[i].name, system, diagnostics);
  for (size_t i = 0; i < equations->rates.count; i++)
    fill_row(model, equations->rates.nodes[i], 2 * n + i, model->states.items[i].name, system, diagnostics);
  return diagnostics->errors == errors ? system : NULL;
}

static void print_matrix(const struct Model *model, const char *name, const Node *matrix, size_t rows, size_t columns,
                         const double *values) {
  printf("%s =\n", name);
  for (size_t i = 0; i < rows; i++) {
    printf("  [");
    for (size_t j = 0; j < columns; j++) {
      Node node = matrix[i * columns + j];
      if (j > 0) printf(", ");
      if (values != NULL) printf("%.15g", values[node]); /* 15 digits: further ones show only rounding */
      else {
        printf("%s", expression_text(model->graph, node));
      }
    }
    printf("]\n");
  }
}

static void print_names(const char *what, const struct VariableList *const *lists, size_t count) {
  const char *separator = what;
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < lists[k]->count; i++, separator = ", ") printf("%s%s", separator, lists[k]->items[i].name);
  printf("\n");
}

void linear_system_print(const struct Model *model, const struct LinearSystem *system) {
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  const struct VariableList *const states[] = {&model->coordinates, &model->velocities, &model->states};
  const struct VariableList *const inputs[] = {&model->inputs};
  print_names("states: ", states, 3);
  if (system->inputs > 0) print_names("inputs: ", inputs, 1);
  print_matrix(model, "A", system->a, system->states, system->states, NULL);
  if (system->inputs > 0) print_matrix(model, "B", system->b, system->states, system->inputs, NULL);
  if (model->parameters.count > 0) printf("at");
  for (size_t i = 0; i < model->parameters.count; i++) {
    printf("%s%s = ", i > 0 ? ", " : " ", model->parameters.items[i].name);
    print_number(stdout, model->parameters.items[i].start);
  }
  printf("%s\n", model->parameters.count > 0 ? ":" : "as numbers:");
  print_matrix(model, "A", system->a, system->states, system->states, values);
  if (system->inputs > 0) print_matrix(model, "B", system->b, system->states, system->inputs, values);
}
