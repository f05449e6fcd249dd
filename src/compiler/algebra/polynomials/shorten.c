#include "algebra/polynomials/shorten.h"

#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/polynomials/rational.h"
#include "base/memory.h"

/* Numbers of operations: evaluated at each time, and once for given parameters. */
struct EvaluationCost {
  size_t in_motion, once;
};

/* Counts the operations of all nodes together. */
static struct EvaluationCost length_of(const struct Graph *graph, const Node *nodes, size_t count) {
  const struct Cone *cone = graph->cone;
  struct EvaluationCost length = {0};
  if (graph_limit(graph) != NULL) return length;
  cone_collect(graph->cone, graph, nodes, count);
  for (size_t index = 0; index < cone->count; index++) {
    if (operation_arity(graph->vertices[cone->nodes[index]].operation) == 0) continue;
    if (graph_is_constant_in_time(graph, cone->nodes[index])) length.once++;
    else length.in_motion++;
  }
  return length;
}

bool are_shorter(const struct Graph *graph, size_t count, const Node *nodes, const Node *others) {
  struct EvaluationCost length = length_of(graph, nodes, count), other = length_of(graph, others, count);
  return length.in_motion != other.in_motion ? length.in_motion < other.in_motion : length.once < other.once;
}

void take_shorter(const struct Graph *graph, size_t count, Node *nodes, const Node *others) {
  if (!are_shorter(graph, count, others, nodes)) return;
  for (size_t i = 0; i < count; i++) nodes[i] = others[i];
}

void shorten(struct Graph *graph, size_t count, Node *nodes) {
  Node *others = allocate(count, sizeof *others);
  for (size_t i = 0; i < count; i++) others[i] = simplify_fraction(graph, nodes[i]);
  take_shorter(graph, count, nodes, others);
  release(others);
}
