#include "mechanics/method_choice.h"

#include "algebra/kinks.h"

/*
 * True if the system may be stiff, with fast modes that decay while slow ones continue: it has dissipation, or
 * inputs whose course is unknown.
 */
static bool may_be_stiff(const struct Model *model, const struct Equations *equations) {
  const struct Graph *graph = model->graph;
  bool may = graph_depends_on(graph, model->energies.dissipation.node, VELOCITY);
  for (size_t i = 0; i < model->coordinates.count; i++)
    may |= graph_depends_on(graph, model->forces.along[i].node, VELOCITY) ||
           graph_depends_on(graph, equations->residual[i], INPUT);
  return may;
}

const struct Method *method_of(const struct Model *model, const struct Equations *equations) {
  if (is_motionless(model)) return NULL;
  if (model->solver.method != NULL) return model->solver.method;
  if (model->linearized) return method_named("exact");
  const char *kink = kink_without_series_of(model->graph, equations->residual, row_count(equations));
  return method_named(kink != NULL ? "erk" : may_be_stiff(model, equations) ? "auto" : "taylor");
}
