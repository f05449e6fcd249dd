#include "algebra/differentiate.h"

#include <stdlib.h>

#include "memory.h"
#include "algebra/simplify.h"

static Node one_minus_square(struct Graph *graph, Node x, double sign) {
  return add(graph, ONE, scale(graph, sign, power_number(graph, x, 2.0)));
}

/* The partial derivatives of an operation with respect to its operands; right stays ZERO for one operand. */
static void partial_derivatives(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  const struct Vertex vertex = graph->vertices[node];
  Node a = vertex.left, b = vertex.right;
  *by_left = *by_right = ZERO;
  switch (vertex.operation) {
  case ADD: *by_left = *by_right = ONE; return;
  case MULTIPLY:
    *by_left = b;
    *by_right = a;
    return;
  case POWER:
    *by_left = multiply(graph, b, power(graph, a, subtract(graph, b, ONE)));
    if (!graph_is_constant(graph, b)) *by_right = multiply(graph, function(graph, LOGARITHM, a, ZERO), node);
    return;
  case ATAN2: {
    Node square = add(graph, power_number(graph, a, 2.0), power_number(graph, b, 2.0));
    *by_left = divide(graph, b, square);
    *by_right = negate(graph, divide(graph, a, square));
    return;
  }
  case MINIMUM:
    *by_right = function(graph, LESS, b, a);
    *by_left = subtract(graph, ONE, *by_right);
    return;
  case MAXIMUM:
    *by_right = function(graph, LESS, a, b);
    *by_left = subtract(graph, ONE, *by_right);
    return;
  case SINE: *by_left = function(graph, COSINE, a, ZERO); return;
  case COSINE: *by_left = negate(graph, function(graph, SINE, a, ZERO)); return;
  case TANGENT: *by_left = one_minus_square(graph, node, 1.0); return;
  case ARCSINE: *by_left = power_number(graph, one_minus_square(graph, a, -1.0), -0.5); return;
  case ARCCOSINE: *by_left = negate(graph, power_number(graph, one_minus_square(graph, a, -1.0), -0.5)); return;
  case ARCTANGENT: *by_left = power_number(graph, one_minus_square(graph, a, 1.0), -1.0); return;
  case SINH: *by_left = function(graph, COSH, a, ZERO); return;
  case COSH: *by_left = function(graph, SINH, a, ZERO); return;
  case TANH: *by_left = one_minus_square(graph, node, -1.0); return;
  case ARSINH: *by_left = power_number(graph, one_minus_square(graph, a, 1.0), -0.5); return;
  case ARCOSH:
    *by_left = power_number(graph, add(graph, power_number(graph, a, 2.0), graph_constant(graph, -1.0)), -0.5);
    return;
  case ARTANH: *by_left = power_number(graph, one_minus_square(graph, a, -1.0), -1.0); return;
  case EXPONENTIAL: *by_left = node; return;
  case LOGARITHM: *by_left = power_number(graph, a, -1.0); return;
  case ABSOLUTE: *by_left = function(graph, SIGN, a, ZERO); return;
  case LESS:
  case SIGN:
  case CONSTANT:
  case SYMBOL:
  case OPERATION_COUNT: return;
  }
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
