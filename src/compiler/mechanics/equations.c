#include "mechanics/equations.h"

#include <math.h>

#include "algebra/cone.h"
#include "base/memory.h"

struct Equations *equations_create(const struct Model *model) {
  size_t n = model->coordinates.count, rows = n + model->constraints.count;
  struct Equations *equations = allocate(1, sizeof *equations);
  *equations =
      (struct Equations){.count = n,
                         .constraints = constraints_derive(model),
                         .right_side = allocate(rows, sizeof(Node)),
                         .residual = allocate(rows, sizeof(Node)),
                         .acceleration = allocate(rows, sizeof(Node)),
                         .reactions = allocate(model->reactions.count, sizeof(Node)),
                         .outputs = allocate(model->outputs.count, sizeof(Node)),
                         .element_variables = allocate(model->mechanism.element_variables.count, sizeof(Node))};
  return equations;
}

/* True if all constants below the nodes are finite. */
static bool are_finite(const struct Graph *graph, const Node *nodes, size_t count) {
  const struct Cone *cone = graph->cone;
  bool finite = true;
  cone_collect(graph->cone, graph, nodes, count);
  for (size_t i = 0; i < cone->count && finite; i++)
    finite = !graph_is_constant(graph, cone->nodes[i]) || isfinite(graph_value(graph, cone->nodes[i]));
  return finite;
}

void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics) {
  size_t wrong = 0;
  for (size_t i = 0; i < model->reactions.count; i++)
    if (!are_finite(model->graph, &equations->reactions[i], 1))
      report_error(diagnostics, model->reactions.items[i].line,
                   "%s is not finite; expected positions that are smooth where the displacements are 0",
                   model->reactions.items[i].name);
  if (are_finite(model->graph, equations->residual, row_count(equations))) return;
  while (are_finite(model->graph, equations->residual + wrong, 1)) wrong++;
  if (wrong >= equations->count) {
    const struct Variable *constraint = &model->constraints.items[wrong - equations->count];
    report_error(diagnostics, constraint->line,
                 "the second time derivative of the constraint '%s' has a coefficient that is not finite; expected "
                 "numbers below 1e308",
                 constraint->name);
    return;
  }
  report_error(diagnostics, model->velocities.items[wrong].line,
               "the equation of der(%s) has a coefficient that is not finite; expected %s",
               model->velocities.items[wrong].name,
               model->linearized ? "an operating point away from poles" : "numbers below 1e308");
}

bool is_looped(const struct Equations *equations, size_t row) {
  return !inertia_block_of(equations->inertia, row)->is_unrolled;
}

size_t row_count(const struct Equations *equations) {
  return equations->count + equations->constraints->count;
}

bool rates_use_unknowns(const struct Graph *graph, const struct Equations *equations) {
  bool use = false;
  for (size_t i = 0; i < equations->rates.count; i++)
    use |= graph_depends_on(graph, equations->rates.nodes[i], ACCELERATION);
  return use;
}
