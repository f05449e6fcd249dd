#include "program/program.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/differentiate.h"
#include "memory.h"
#include "algebra/simplify.h"

/* A seed symbol for every symbol that results can depend on; returned in the order of the graph's symbols. */
static Node *create_seeds(struct Graph *graph) {
  static const enum SymbolKind seed_kinds[] = {
      [PARAMETER] = SEED_PARAMETER, [TIME] = SEED_TIME,   [COORDINATE] = SEED_COORDINATE,
      [VELOCITY] = SEED_VELOCITY,   [INPUT] = SEED_INPUT, [ACCELERATION] = SEED_ACCELERATION,
  };
  size_t count = graph->symbol_count;
  Node *seeds = allocate(2 * count, sizeof *seeds);
  for (size_t i = 0; i < count; i++) {
    char *name = format_text("d %s", graph->symbols[i].name);
    seeds[i] = graph_symbol(graph, seed_kinds[graph->symbols[i].kind], graph->symbols[i].index, name);
    free(name);
  }
  return seeds;
}

/*
 * Along a direction, 0 = d (M a - right_side) = M da + d(M a - right_side)|a held; explicit accelerations are
 * differentiated as they are. In large blocks result holds the right side of this system.
 */
static void accelerations_along(struct Graph *graph, const struct Equations *equations, const Node *seeds,
                                Node *result) {
  size_t n = equations->count;
  derivative_along(graph, equations->explicit_form ? equations->acceleration : equations->residual, n, seeds, result);
  if (equations->explicit_form) return;
  Node *right = allocate(n, sizeof *right);
  for (size_t i = 0; i < n; i++) right[i] = negate(graph, result[i]);
  equations_solve(graph, equations, right, result);
  for (size_t i = 0; i < n; i++)
    if (!equations->unrolled[equations->block[i]]) result[i] = right[i];
  free(right);
}

static void without_accelerations(const struct Graph *graph, Node *seeds) {
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == ACCELERATION) seeds[i] = ZERO;
}

static void create_jacobian(struct Program *program, struct Graph *graph) {
  const struct Model *model = program->model;
  size_t n = program->equations->count, states = program->interface->state_count;
  program->jacobian = allocate(n * states, sizeof(Node));
  program->power_jacobian = allocate(states, sizeof(Node));
  Node *column = allocate(n, sizeof *column);
  for (size_t j = 0; j < 2 * n; j++) {
    Node symbol = j < n ? model->coordinates.items[j].node : model->velocities.items[j - n].node;
    Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
    seeds[graph->vertices[symbol].left] = ONE;
    accelerations_along(graph, program->equations, seeds, column);
    for (size_t i = 0; i < n; i++) program->jacobian[i * states + j] = column[i];
    free(seeds);
    if (model->work_line > 0) program->power_jacobian[j] = derivative_by(graph, program->equations->power, symbol);
  }
  free(column);
}

/* The methods of SUNDIALS take the first coefficients alone, to see how far a step may go. */
static void create_series(struct Program *program, const struct Model *model, struct Diagnostics *diagnostics) {
  const struct Equations *equations = program->equations;
  const char *kink = kink_without_series_of(model->graph, equations->residual, equations->count);
  bool is_taylor = program->interface->method->series == ALL_TERMS;
  if (kink == NULL || !is_taylor)
    program->series = series_plan_of_motion(model->graph, equations, model->work_line > 0);
  else
    report_error(diagnostics, model->solver_line,
                 "%s has a kink, where a Taylor series ends; expected the method 'erk' for such a system", kink);
}

static void create_output_series(struct Program *program, const struct Model *model) {
  size_t count = model->outputs.count;
  if (count == 0 || program->interface->output_derivative_order == 1) return;
  Node *outputs = allocate(count, sizeof *outputs);
  for (size_t i = 0; i < count; i++) outputs[i] = model->outputs.items[i].node;
  program->output_series = series_plan_of_outputs(model->graph, outputs, count);
  free(outputs);
}

struct Program *program_create(struct Model *model, const struct Equations *equations,
                               const struct Interface *interface, struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  const struct Method *method = interface->method;
  size_t n = equations->count;
  int errors = diagnostics->errors;
  struct Program *program = allocate(1, sizeof *program);
  *program = (struct Program){.model = model, .equations = equations, .interface = interface};
  if (method != NULL && method->needs_linear) {
    if (!isnan(model->max_step))
      report_error(diagnostics, model->solver_line,
                   "the method 'exact' takes a communication step as a whole; expected no maxStep");
    program->linear = linear_system_of(model, equations, diagnostics);
    if (model->work_line > 0)
      report_error(diagnostics, model->solver_line,
                   "<work/> is not linear in the state; expected another method than 'exact'");
  }
  Node *seeds = create_seeds(graph);
  program->result_along = allocate(interface->result_count, sizeof(Node));
  for (size_t i = 0; i < interface->count; i++) {
    const struct InterfaceVariable *variable = &interface->variables[i];
    if (variable->entry.kind == VARIABLE_RESULT && variable->entry.is_output)
      derivative_along(graph, &variable->node, 1, seeds, &program->result_along[variable->entry.index]);
  }
  without_accelerations(graph, seeds);
  program->along = allocate(n, sizeof(Node));
  accelerations_along(graph, equations, seeds, program->along);
  derivative_along(graph, &equations->power, 1, seeds, &program->power_along);
  if (method != NULL && method->needs_jacobian) create_jacobian(program, graph);
  free(seeds);
  if (method != NULL && method->series != NO_SERIES) create_series(program, model, diagnostics);
  create_output_series(program, model);
  if (graph->overflow)
    report_error(diagnostics, 0, "the generated code needs more than %d operations; expected a smaller system",
                 NODE_LIMIT);
  if (diagnostics->errors == errors) return program;
  program_free(program);
  return NULL;
}

void program_free(struct Program *program) {
  if (program == NULL) return;
  linear_system_free(program->linear);
  series_plan_free(program->series);
  series_plan_free(program->output_series);
  free(program->along);
  free(program->jacobian);
  free(program->power_jacobian);
  free(program->result_along);
  free(program);
}
