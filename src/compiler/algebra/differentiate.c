#include "algebra/differentiate.h"

#include <stdlib.h>

#include "memory.h"
#include "algebra/functions.h"
#include "algebra/simplify.h"

/* The partial derivatives of an operation with respect to its operands; right stays ZERO for one operand. */
static void partial_derivatives(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  const struct Function *row = &functions[graph->vertices[node].operation];
  *by_left = *by_right = ZERO;
  if (row->partial_derivatives != NULL) row->partial_derivatives(graph, node, by_left, by_right);
  else if (row->recurrence == INTEGRAL) *by_left = scale(graph, row->sign, row->auxiliary(graph, node));
  else if (row->recurrence == RATIO)
    *by_left = scale(graph, row->sign, power_number(graph, row->auxiliary(graph, node), -1.0));
}

/*
 * What the exponent of a power contributes along a direction: log(base) base^exponent seed, which is 0 for a parameter
 * that is not varied, even where the base is negative and has no logarithm.
 */
static Node along_exponent(struct Graph *graph, Node node, Node by_exponent, Node seed) {
  if (!graph_depends_on(graph, seed, SEED_PARAMETER)) return multiply(graph, by_exponent, seed);
  Node varied = function(graph, ABSOLUTE, function(graph, SIGN, seed, ZERO), ZERO);
  Node base = function(graph, MAXIMUM, graph->vertices[node].left, subtract(graph, ONE, varied));
  return multiply(graph, multiply(graph, function(graph, LOGARITHM, base, ZERO), node), seed);
}

static Node last_of(const Node *targets, size_t count) {
  Node last = 0;
  for (size_t i = 0; i < count; i++)
    if (targets[i] > last) last = targets[i];
  return last;
}

void derivative_along(struct Graph *graph, const Node *targets, size_t count, const Node *seeds, Node *derivatives) {
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, targets, count, needed);
  Node last = last_of(targets, count);
  Node *along = allocate((size_t)last + 1, sizeof *along);
  for (Node node = 0; node <= last; node++) {
    if (!needed[node]) continue;
    const struct Vertex vertex = graph->vertices[node];
    int arity = operation_arity(vertex.operation);
    if (vertex.operation == SYMBOL) along[node] = seeds[vertex.left];
    if (arity == 0 || (along[vertex.left] == ZERO && (arity == 1 || along[vertex.right] == ZERO))) continue;
    Node by_left, by_right;
    partial_derivatives(graph, node, &by_left, &by_right);
    along[node] = multiply(graph, by_left, along[vertex.left]);
    if (arity == 1) continue;
    Node along_right = vertex.operation == POWER ? along_exponent(graph, node, by_right, along[vertex.right])
                                                 : multiply(graph, by_right, along[vertex.right]);
    along[node] = add(graph, along[node], along_right);
  }
  for (size_t i = 0; i < count; i++) derivatives[i] = along[targets[i]];
  free(along);
  free(needed);
}

Node derivative_by(struct Graph *graph, Node target, Node symbol) {
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[symbol].left] = ONE;
  Node derivative;
  derivative_along(graph, &target, 1, seeds, &derivative);
  free(seeds);
  return derivative;
}

void gradient_of(struct Graph *graph, Node target, const Node *symbols, size_t count, Node *gradient) {
  const Node weight = ONE;
  weighted_gradient_of(graph, &target, &weight, 1, symbols, count, gradient);
}

void weighted_gradient_of(struct Graph *graph, const Node *targets, const Node *weights, size_t target_count,
                          const Node *symbols, size_t count, Node *gradient) {
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, targets, target_count, needed);
  Node last = last_of(targets, target_count);
  Node *adjoint = allocate((size_t)last + 1, sizeof *adjoint);
  for (size_t k = 0; k < target_count; k++) adjoint[targets[k]] = add(graph, adjoint[targets[k]], weights[k]);
  for (Node node = last + 1; node-- > 0;) {
    const struct Vertex vertex = graph->vertices[node];
    int arity = operation_arity(vertex.operation);
    if (!needed[node] || adjoint[node] == ZERO || arity == 0) continue;
    Node by_left, by_right;
    partial_derivatives(graph, node, &by_left, &by_right);
    if (!graph_is_constant(graph, vertex.left))
      adjoint[vertex.left] = add(graph, adjoint[vertex.left], multiply(graph, adjoint[node], by_left));
    if (arity == 2 && !graph_is_constant(graph, vertex.right))
      adjoint[vertex.right] = add(graph, adjoint[vertex.right], multiply(graph, adjoint[node], by_right));
  }
  for (size_t i = 0; i < count; i++) gradient[i] = symbols[i] <= last ? adjoint[symbols[i]] : ZERO;
  free(adjoint);
  free(needed);
}

void substitute(struct Graph *graph, const Node *targets, size_t count, const Node *replacements, Node *results) {
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, targets, count, needed);
  Node last = last_of(targets, count);
  Node *mapped = allocate((size_t)last + 1, sizeof *mapped);
  for (Node node = 0; node <= last; node++) {
    if (!needed[node]) continue;
    const struct Vertex vertex = graph->vertices[node];
    Node left = operation_arity(vertex.operation) > 0 ? mapped[vertex.left] : ZERO;
    Node right = operation_arity(vertex.operation) > 1 ? mapped[vertex.right] : ZERO;
    switch (vertex.operation) {
    case CONSTANT: mapped[node] = node; break;
    case SYMBOL: mapped[node] = replacements[vertex.left]; break;
    case ADD: mapped[node] = add(graph, left, right); break;
    case MULTIPLY: mapped[node] = multiply(graph, left, right); break;
    case POWER: mapped[node] = power(graph, left, right); break;
    default: mapped[node] = function(graph, vertex.operation, left, right); break;
    }
  }
  for (size_t i = 0; i < count; i++) results[i] = mapped[targets[i]];
  free(mapped);
  free(needed);
}
