#include "mechanics/summary.h"

#include <stdlib.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "algebra/formula.h"
#include "algebra/rational.h"
#include "algebra/simplify.h"
#include "memory.h"

/* The expression as it is, or multiplied out where that is shorter to read. */
static Node readable(struct Graph *graph, Node node) {
  Node expanded = simplify_fraction(graph, node);
  if (expanded == node) return node;
  char *text = expression_text(graph, node), *expanded_text = expression_text(graph, expanded);
  bool shorter = strlen(expanded_text) < strlen(text);
  free(text);
  free(expanded_text);
  return shorter ? expanded : node;
}

/* Row i of M a, or the acceleration itself. */
static Node inertial_side(const struct Model *model, const struct Equations *equations, size_t i) {
  struct Graph *graph = model->graph;
  if (equations->explicit_form) return model->accelerations[i];
  const struct InertiaBlock *block = inertia_block_of(equations->inertia, i);
  Node sum = ZERO;
  for (size_t k = 0; k < block->count; k++) {
    Node mass = inertia_element(equations->inertia, i, block->coordinates[k]);
    sum = add(graph, sum, multiply(graph, mass, model->accelerations[block->coordinates[k]]));
  }
  return readable(graph, sum);
}

static size_t at_most(size_t count, size_t limit) {
  return count < limit ? count : limit;
}

struct Summary *summary_create(const struct Model *model, const struct Equations *equations) {
  struct Graph *graph = model->graph;
  struct Summary *summary = allocate(1, sizeof *summary);
  Node lagrangian = subtract(graph, model->kinetic.node, model->potential.node);
  *summary =
      (struct Summary){.lagrangian_kinetic = readable(graph, model->kinetic.node),
                       .kinetic = readable(graph, equations->kinetic),
                       .potential = readable(graph, model->linearized ? equations->potential : model->potential.node),
                       .power = readable(graph, equations->power),
                       .is_autonomous = simplify_fraction(graph, derivative_by(graph, lagrangian, model->time)) == ZERO,
                       .motion_count = at_most(equations->count, SHOWN_LIMIT),
                       .output_count = at_most(model->outputs.count, SHOWN_LIMIT)};
  summary->inertial = allocate(summary->motion_count, sizeof(Node));
  summary->right_side = allocate(summary->motion_count, sizeof(Node));
  summary->outputs = allocate(summary->output_count, sizeof(Node));
  for (size_t i = 0; i < summary->motion_count; i++) {
    summary->inertial[i] = inertial_side(model, equations, i);
    summary->right_side[i] = readable(graph, equations->right_side[i]);
  }
  for (size_t i = 0; i < summary->output_count; i++) summary->outputs[i] = readable(graph, equations->outputs[i]);
  return summary;
}

void summary_free(struct Summary *summary) {
  if (summary == NULL) return;
  free(summary->inertial);
  free(summary->right_side);
  free(summary->outputs);
  free(summary);
}
