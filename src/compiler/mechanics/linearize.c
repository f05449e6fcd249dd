#include "mechanics/linearize.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "algebra/differentiate.h"
#include "memory.h"
#include "algebra/formula.h"
#include "algebra/rational.h"
#include "algebra/simplify.h"

/* States, inputs and accelerations with their values at the point, and their deviations from it. */
struct Expansion {
  struct Graph *graph;
  Node *replacements; /* one node a symbol: its value at the point */
  Node *symbols, *deviations;
  size_t count;
};

static Node at_point(const struct Expansion *expansion, Node node) {
  Node value;
  substitute(expansion->graph, &node, 1, expansion->replacements, &value);
  return value;
}

static void add_symbol(struct Expansion *expansion, Node symbol, Node value) {
  expansion->replacements[expansion->graph->vertices[symbol].left] = value;
  expansion->symbols[expansion->count] = symbol;
  expansion->deviations[expansion->count++] = subtract(expansion->graph, symbol, value);
}

/* Taylor's polynomial of the first or second order at the point. */
static Node expand(const struct Expansion *expansion, Node node, int order) {
  struct Graph *graph = expansion->graph;
  Node result = at_point(expansion, node);
  for (size_t i = 0; i < expansion->count; i++) {
    Node slope = derivative_by(graph, node, expansion->symbols[i]);
    Node term = at_point(expansion, slope);
    for (size_t j = 0; order == 2 && j < expansion->count && slope != ZERO; j++) {
      Node curvature = at_point(expansion, derivative_by(graph, slope, expansion->symbols[j]));
      term = add(graph, term, scale(graph, 0.5, multiply(graph, curvature, expansion->deviations[j])));
    }
    result = add(graph, result, multiply(graph, term, expansion->deviations[i]));
  }
  return result;
}

static Node point_of(const struct Model *model, Node symbol) {
  return model->point.values[model->graph->vertices[symbol].left];
}

static struct Expansion expansion_create(struct Model *model, const Node *accelerations) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count, m = model->inputs.count;
  struct Expansion expansion = {.graph = graph};
  expansion.replacements = allocate(graph->symbol_count, sizeof(Node));
  expansion.symbols = allocate(3 * n + m, sizeof(Node));
  expansion.deviations = allocate(3 * n + m, sizeof(Node));
  for (size_t i = 0; i < graph->symbol_count; i++) expansion.replacements[i] = graph->symbols[i].node;
  const struct VariableList *lists[] = {&model->coordinates, &model->velocities, &model->inputs};
  for (size_t list = 0; list < 3; list++)
    for (size_t i = 0; i < lists[list]->count; i++)
      add_symbol(&expansion, lists[list]->items[i].node, point_of(model, lists[list]->items[i].node));
  for (size_t i = 0; i < n && accelerations != NULL; i++)
    add_symbol(&expansion, model->accelerations[i], accelerations[i]);
  return expansion;
}

static void expansion_free(struct Expansion *expansion) {
  free(expansion->replacements);
  free(expansion->symbols);
  free(expansion->deviations);
}

static void warn_without_equilibrium(const struct Model *model, const Node *accelerations,
                                     const struct Diagnostics *diagnostics) {
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  for (size_t i = 0; i < model->coordinates.count; i++) {
    double velocity = values[point_of(model, model->velocities.items[i].node)];
    double acceleration = values[accelerations[i]];
    if (fabs(velocity) > 1e-9 || !(fabs(acceleration) < 1e-9))
      report_warning(diagnostics, 0, "the point is no equilibrium: %s = %g, der(%s) = %g there",
                     model->velocities.items[i].name, velocity, model->velocities.items[i].name, acceleration);
  }
  free(values);
  free(symbols);
}

/* M solution = right for several right sides by rows, in fractions where they are not too large. */
static void solve_columns(struct Graph *graph, const struct Inertia *inertia, size_t columns, const Node *right,
                          Node *solution) {
  size_t n = inertia->count;
  Node *mass = allocate(n * n, sizeof *mass), *column = allocate(n, sizeof *column);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) mass[i * n + j] = inertia_element(inertia, i, j);
  bool solved = solve_fractions(graph, n, mass, columns, right, solution);
  for (size_t j = 0; j < columns && !solved; j++) {
    for (size_t i = 0; i < n; i++) column[i] = right[i * columns + j];
    inertia_solve(graph, inertia, column, column);
    for (size_t i = 0; i < n; i++) solution[i * columns + j] = column[i];
  }
  free(mass);
  free(column);
}

/* M da = -(d residual / d s) ds with M and the acceleration held at their values at the point. */
static void linearize_accelerations(struct Model *model, struct Equations *equations, const struct Inertia *inertia) {
  struct Graph *graph = model->graph;
  size_t n = equations->count;
  struct Expansion states = expansion_create(model, NULL);
  Node *value = allocate(n, sizeof *value), *slopes = allocate(n * states.count, sizeof *slopes);
  substitute(graph, equations->right_side, n, states.replacements, value);
  solve_columns(graph, inertia, 1, value, value);
  struct Expansion all = expansion_create(model, value);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < states.count; j++)
      slopes[i * states.count + j] =
          negate(graph, at_point(&all, derivative_by(graph, equations->residual[i], states.symbols[j])));
  solve_columns(graph, inertia, states.count, slopes, slopes);
  for (size_t i = 0; i < n; i++) {
    equations->acceleration[i] = value[i];
    for (size_t j = 0; j < states.count; j++)
      equations->acceleration[i] =
          add(graph, equations->acceleration[i], multiply(graph, slopes[i * states.count + j], states.deviations[j]));
  }
  for (size_t i = 0; i < model->outputs.count; i++)
    model->outputs.items[i].node = expand(&all, model->outputs.items[i].node, 1);
  free(value);
  free(slopes);
  expansion_free(&states);
  expansion_free(&all);
}

static void expand_positions(struct Model *model, const struct Expansion *expansion) {
  for (size_t i = 0; i < model->body_count; i++) {
    struct Body *body = &model->bodies[i];
    for (int axis = 0; axis < 3; axis++) body->position[axis].node = expand(expansion, body->position[axis].node, 1);
    body->angle.node = expand(expansion, body->angle.node, 1);
  }
}

static bool depends_on_time(const struct Model *model, const struct Equations *equations) {
  for (size_t i = 0; i < equations->count; i++)
    if (graph_depends_on(model->graph, equations->residual[i], TIME)) return true;
  return false;
}

static bool is_singular(const struct Model *model, const struct Inertia *inertia, struct Diagnostics *diagnostics) {
  bool singular = false;
  for (size_t i = 0; i < inertia->count; i++) {
    if (inertia_element(inertia, i, i) != ZERO) continue;
    report_error(diagnostics, 0,
                 "the mass matrix is singular in coordinate '%s' at this point; expected a point where it is not",
                 model->coordinates.items[i].name);
    singular = true;
  }
  return singular;
}

void linearize(struct Model *model, struct Equations *equations, struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  if (depends_on_time(model, equations)) {
    report_error(diagnostics, 0, "the equations of motion depend on time; expected an autonomous system to linearise");
    return;
  }
  if (equations->count == 0) {
    report_error(diagnostics, 0, "the system has no coordinates; expected some to linearise");
    return;
  }
  struct Expansion expansion = expansion_create(model, NULL);
  struct Inertia *inertia = inertia_substitute(graph, equations->inertia, expansion.replacements);
  if (is_singular(model, inertia, diagnostics)) {
    inertia_free(inertia);
    expansion_free(&expansion);
    return;
  }
  Node *values = allocate(equations->count, sizeof *values);
  substitute(graph, equations->acceleration, equations->count, expansion.replacements, values);
  warn_without_equilibrium(model, values, diagnostics);
  linearize_accelerations(model, equations, inertia);
  expand_positions(model, &expansion);
  equations->kinetic = expand(&expansion, equations->kinetic, 2);
  equations->potential = expand(&expansion, equations->potential, 2);
  equations->total = add(graph, equations->kinetic, equations->potential);
  inertia_free(equations->inertia);
  equations->inertia = inertia;
  equations->explicit_form = true;
  model->work_line = 0;
  free(values);
  expansion_free(&expansion);
}

static bool is_constant_in_motion(const struct Graph *graph, Node node) {
  return (graph->vertices[node].kinds & ~(1u << PARAMETER)) == 0;
}

/* One element of A or B; reports where the derivative is not constant. */
static Node coefficient(struct Model *model, const struct Equations *equations, size_t row, Node symbol,
                        struct Diagnostics *diagnostics) {
  Node slope = derivative_by(model->graph, equations->acceleration[row], symbol);
  slope = simplify_fraction(model->graph, slope);
  if (!is_constant_in_motion(model->graph, slope))
    report_error(diagnostics, model->solver_line,
                 "the system is not linear: der(%s) is not linear in %s; expected another method than 'exact'",
                 model->velocities.items[row].name, graph_symbol_of(model->graph, symbol)->name);
  return slope;
}

static void fill_accelerations(struct Model *model, const struct Equations *equations, struct LinearSystem *system,
                               struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  size_t n = equations->count;
  Node *zero = allocate(graph->symbol_count, sizeof *zero);
  for (size_t i = 0; i < model->parameters.count; i++)
    zero[graph->vertices[model->parameters.items[i].node].left] = model->parameters.items[i].node;
  zero[graph->vertices[model->time].left] = model->time;
  for (size_t i = 0; i < n; i++) {
    size_t row = n + i;
    for (size_t j = 0; j < n; j++) {
      Node q = model->coordinates.items[j].node, v = model->velocities.items[j].node;
      system->a[row * 2 * n + j] = coefficient(model, equations, i, q, diagnostics);
      system->a[row * 2 * n + n + j] = coefficient(model, equations, i, v, diagnostics);
    }
    for (size_t j = 0; j < system->inputs; j++)
      system->b[row * system->inputs + j] = coefficient(model, equations, i, model->inputs.items[j].node, diagnostics);
    substitute(graph, &equations->acceleration[i], 1, zero, &system->c[row]);
    if (!is_constant_in_motion(graph, system->c[row]))
      report_error(diagnostics, model->solver_line,
                   "the system is not linear with constant coefficients: der(%s) depends on time; expected another "
                   "method than 'exact'",
                   model->velocities.items[i].name);
  }
  free(zero);
}

struct LinearSystem *linear_system_of(struct Model *model, const struct Equations *equations,
                                      struct Diagnostics *diagnostics) {
  size_t n = equations->count;
  struct LinearSystem *system = allocate(1, sizeof *system);
  system->states = 2 * n;
  system->inputs = model->inputs.count;
  system->a = allocate(4 * n * n, sizeof(Node));
  system->b = allocate(2 * n * system->inputs, sizeof(Node));
  system->c = allocate(2 * n, sizeof(Node));
  for (size_t i = 0; i < n; i++) system->a[i * 2 * n + n + i] = ONE;
  int errors = diagnostics->errors;
  fill_accelerations(model, equations, system, diagnostics);
  if (diagnostics->errors == errors) return system;
  linear_system_free(system);
  return NULL;
}

void linear_system_free(struct LinearSystem *system) {
  if (system == NULL) return;
  free(system->a);
  free(system->b);
  free(system->c);
  free(system);
}

static void print_matrix(const struct Model *model, const char *name, const Node *matrix, size_t rows, size_t columns,
                         const double *values) {
  printf("%s =\n", name);
  for (size_t i = 0; i < rows; i++) {
    printf("  [");
    for (size_t j = 0; j < columns; j++) {
      Node node = matrix[i * columns + j];
      if (j > 0) printf(", ");
      if (values != NULL) print_number(stdout, values[node]);
      else {
        char *text = expression_text(model->graph, node);
        printf("%s", text);
        free(text);
      }
    }
    printf("]\n");
  }
}

static void print_names(const char *what, const struct VariableList *list, bool more) {
  printf("%s", what);
  for (size_t i = 0; i < list->count; i++) printf("%s%s", i > 0 ? ", " : "", list->items[i].name);
  printf(more ? ", " : "\n");
}

void linear_system_print(const struct Model *model, const struct LinearSystem *system) {
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  print_names("states: ", &model->coordinates, true);
  print_names("", &model->velocities, false);
  if (system->inputs > 0) print_names("inputs: ", &model->inputs, false);
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
  free(values);
  free(symbols);
}
