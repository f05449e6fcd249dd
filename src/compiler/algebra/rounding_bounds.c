#include "algebra/rounding_bounds.h"

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/functions.h"
#include "algebra/simplify.h"
#include "base/memory.h"

static Node magnitude(struct Graph *graph, Node node) {
  return function(graph, ABSOLUTE, node, ZERO);
}

/* Returns the bound of a value from those of its operands. */
static Node rounding_of(struct Graph *graph, Node node, Node left, Node right) {
  enum Operation operation = graph->vertices[node].operation;
  if (operation == GUARD) return function(graph, GUARD, graph->vertices[node].left, right);
  if (functions[operation].recurrence == PIECEWISE_CONSTANT) return ZERO;
  Node by_left, by_right;
  partial_derivatives(graph, node, &by_left, &by_right);
  Node of_left = left == ZERO ? ZERO : multiply(graph, magnitude(graph, by_left), left);
  Node of_right = right == ZERO ? ZERO : multiply(graph, magnitude(graph, by_right), right);
  Node own = magnitude(graph, node);
  return add(graph, add(graph, of_left, of_right), own);
}

void rounding_bounds_of(struct Graph *graph, const Node *targets, size_t count, Node *rounding_bounds) {
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, targets, count);
  Node *rounding = allocate(cone->count, sizeof *rounding);
  for (size_t index = 0; index < cone->count; index++) {
    const struct Vertex vertex = graph->vertices[cone->nodes[index]];
    int arity = operation_arity(vertex.operation);
    if (arity == 0 || graph_limit(graph) != NULL) continue;
    Node left = rounding[cone_slot(cone, vertex.left)];
    Node right = arity == 2 ? rounding[cone_slot(cone, vertex.right)] : ZERO;
    rounding[index] = rounding_of(graph, cone->nodes[index], left, right);
  }
  for (size_t i = 0; i < count; i++) rounding_bounds[i] = rounding[cone_slot(cone, targets[i])];
}
