#include "algebra/differentiate.h"

#include "algebra/cone.h"
#include "algebra/functions.h"
#include "algebra/simplify.h"
#include "base/memory.h"

void partial_derivatives(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  const struct Function *row = &functions[graph->vertices[node].operation];
  *by_left = *by_right = ZERO;
  if (row->partial_derivatives != NULL) row->partial_derivatives(graph, node, by_left, by_right);
  else if (row->recurrence == INTEGRAL) *by_left = scale(graph, recurrence_sign(row), row->auxiliary(graph, node));
  else if (row->recurrence == RATIO)
    *by_left = scale(graph, recurrence_sign(row), power_number(graph, row->auxiliary(graph, node), -1.0));
}

/*
 * Returns the contribution of an exponent's seed: log(base) base^exponent seed. It is 0 for a parameter with seed 0,
 * even if the base is negative and has no logarithm.
 */
static Node along_exponent(struct Graph *graph, Node node, Node by_exponent, Node seed) {
  if (!graph_depends_on(graph, seed, SEED_PARAMETER)) return multiply(graph, by_exponent, seed);
  Node varied = function(graph, ABSOLUTE, function(graph, SIGN, seed, ZERO), ZERO);
  Node base = function(graph, MAXIMUM, graph->vertices[node].left, subtract(graph, ONE, varied));
  return multiply(graph, multiply(graph, function(graph, LOGARITHM, base, ZERO), node), seed);
}

/* Returns weight by. The guards of weight enclose the product, since by may be undefined where a guard is closed. */
static Node guarded_product(struct Graph *graph, Node weight, Node by) {
  const struct Vertex vertex = graph->vertices[weight];
  if (vertex.operation == GUARD) return function(graph, GUARD, vertex.left, guarded_product(graph, vertex.right, by));
  bool is_sum_of_guards = vertex.operation == ADD && graph->vertices[vertex.left].operation == GUARD &&
                          graph->vertices[vertex.right].operation == GUARD;
  if (!is_sum_of_guards) return multiply(graph, weight, by);
  Node first = guarded_product(graph, vertex.left, by);
  return add(graph, first, guarded_product(graph, vertex.right, by));
}

/* Returns the derivative of an operation from those of its operands. */
static Node along_operands(struct Graph *graph, Node node, Node along_left, Node along_right) {
  const struct Vertex vertex = graph->vertices[node];
  if (along_left == ZERO && along_right == ZERO) return ZERO;
  if (vertex.operation == GUARD) return function(graph, GUARD, vertex.left, along_right);
  Node by_left, by_right;
  partial_derivatives(graph, node, &by_left, &by_right);
  Node along = guarded_product(graph, along_left, by_left);
  if (operation_arity(vertex.operation) == 1) return along;
  along_right = vertex.operation == POWER ? along_exponent(graph, node, by_right, along_right)
                                          : guarded_product(graph, along_right, by_right);
  return add(graph, along, along_right);
}

void derivative_along(struct Graph *graph, const Node *targets, size_t count, const Node *seeds, Node *derivatives) {
  struct Cone *cone = graph->cone;
  if (graph_limit(graph) != NULL) count = 0; /* results then have no meaning */
  cone_collect(cone, graph, targets, count);
  Node *along = allocate(cone->count, sizeof *along);
  for (size_t index = 0; index < cone->count; index++) {
    const struct Vertex vertex = graph->vertices[cone->nodes[index]];
    int arity = operation_arity(vertex.operation);
    if (vertex.operation == SYMBOL) along[index] = seeds[vertex.left];
    if (arity == 0) continue;
    along[index] = along_operands(graph, cone->nodes[index], along[cone_slot(cone, vertex.left)],
                                  arity == 2 ? along[cone_slot(cone, vertex.right)] : ZERO);
  }
  for (size_t i = 0; i < count; i++) derivatives[i] = along[cone_slot(cone, targets[i])];
}

static enum Visit visit_unknown(void *context, const struct Graph *graph, Node node) {
  const struct Derivatives *known = context;
  (void)graph;
  return known->is_known[node] ? VISIT_NOTHING_BELOW : VISIT_OPERANDS;
}

static void make_room_for(struct Derivatives *known, size_t count) {
  if (count <= known->capacity) return;
  count *= 2;
  known->of = reallocate(known->of, count, sizeof *known->of);
  known->is_known = reallocate(known->is_known, count, sizeof *known->is_known);
  for (size_t i = known->capacity; i < count; i++) known->is_known[i] = false;
  known->capacity = count;
}

void derivatives_find(struct Graph *graph, const Node *targets, size_t count, const Node *seeds,
                      struct Derivatives *known, Node *derivatives) {
  struct Cone *cone = graph->cone;
  if (graph_limit(graph) != NULL) return;
  make_room_for(known, graph->count);
  cone_collect_part(cone, graph, targets, count, visit_unknown, known);
  for (size_t index = 0; index < cone->count; index++) {
    Node node = cone->nodes[index];
    const struct Vertex vertex = graph->vertices[node];
    int arity = operation_arity(vertex.operation);
    if (known->is_known[node]) continue;
    known->is_known[node] = true;
    if (arity == 0) known->of[node] = vertex.operation == SYMBOL ? seeds[vertex.left] : ZERO;
    else
      known->of[node] =
          along_operands(graph, node, known->of[vertex.left], arity == 2 ? known->of[vertex.right] : ZERO);
  }
  for (size_t i = 0; i < count; i++) derivatives[i] = known->of[targets[i]];
}

Node derivative_by(struct Graph *graph, Node target, Node symbol) {
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[symbol].left] = ONE;
  Node derivative = ZERO;
  derivative_along(graph, &target, 1, seeds, &derivative);
  release(seeds);
  return derivative;
}

/* Adds weight by to the adjoint of an operand, if the operand depends on the kinds. */
static void add_adjoint(struct Graph *graph, unsigned kinds, Node *adjoint, Node operand, Node weight, Node by) {
  if ((graph->vertices[operand].kinds & kinds) == 0) return;
  Node *sum = &adjoint[cone_slot(graph->cone, operand)];
  *sum = add(graph, *sum, guarded_product(graph, weight, by));
}

/* Returns the adjoints of the symbols of the kinds; adjoint has one element for each member of the cone. */
static struct Gradient take_symbols(const struct Graph *graph, unsigned kinds, const Node *adjoint) {
  const struct Cone *cone = graph->cone;
  struct Gradient gradient = {NULL, NULL, 0};
  for (size_t index = 0; index < cone->count; index++) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[index]];
    if (vertex->operation != SYMBOL || (vertex->kinds & kinds) == 0 || adjoint[index] == ZERO) continue;
    gradient.symbols = make_room(gradient.symbols, gradient.count, sizeof(Node));
    gradient.values = make_room(gradient.values, gradient.count, sizeof(Node));
    gradient.symbols[gradient.count] = cone->nodes[index];
    gradient.values[gradient.count++] = adjoint[index];
  }
  return gradient;
}

/* Skips nodes that depend on no symbol of the kinds. */
static enum Visit visit_kinds(void *kinds, const struct Graph *graph, Node node) {
  return (graph->vertices[node].kinds & *(unsigned *)kinds) != 0 ? VISIT_OPERANDS : VISIT_NOTHING_BELOW;
}

struct Gradient weighted_gradient(struct Graph *graph, const Node *targets, const Node *weights, size_t count,
                                  unsigned kinds) {
  struct Cone *cone = graph->cone;
  if (graph_limit(graph) != NULL) count = 0;
  cone_collect_part(cone, graph, targets, count, visit_kinds, &kinds);
  Node *adjoint = allocate(cone->count, sizeof *adjoint);
  for (size_t k = 0; k < count; k++) add_adjoint(graph, kinds, adjoint, targets[k], weights[k], ONE);
  for (size_t index = cone->count; index-- > 0;) {
    Node node = cone->nodes[index];
    const struct Vertex vertex = graph->vertices[node];
    int arity = operation_arity(vertex.operation);
    if (adjoint[index] == ZERO || arity == 0) continue;
    if (vertex.operation == GUARD) {
      add_adjoint(graph, kinds, adjoint, vertex.right, function(graph, GUARD, vertex.left, adjoint[index]), ONE);
      continue;
    }
    Node by_left, by_right;
    partial_derivatives(graph, node, &by_left, &by_right);
    add_adjoint(graph, kinds, adjoint, vertex.left, adjoint[index], by_left);
    if (arity == 2) add_adjoint(graph, kinds, adjoint, vertex.right, adjoint[index], by_right);
  }
  struct Gradient gradient = take_symbols(graph, kinds, adjoint);
  release(adjoint);
  return gradient;
}

struct Gradient gradient_by_kinds(struct Graph *graph, Node target, unsigned kinds) {
  const Node weight = ONE;
  return weighted_gradient(graph, &target, &weight, 1, kinds);
}

void weighted_gradient_of(struct Graph *graph, const Node *targets, const Node *weights, size_t target_count,
                          enum SymbolKind kind, size_t count, Node *gradient) {
  struct Gradient sparse = weighted_gradient(graph, targets, weights, target_count, 1u << kind);
  for (size_t i = 0; i < count; i++) gradient[i] = ZERO;
  for (size_t i = 0; i < sparse.count; i++)
    gradient[graph_symbol_of(graph, sparse.symbols[i])->index] = sparse.values[i];
}

void gradient_of(struct Graph *graph, Node target, enum SymbolKind kind, size_t count, Node *gradient) {
  const Node weight = ONE;
  weighted_gradient_of(graph, &target, &weight, 1, kind, count, gradient);
}

Node *own_symbols(const struct Graph *graph) {
  Node *symbols = allocate(graph->symbol_count, sizeof *symbols);
  for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = graph->symbols[i].node;
  return symbols;
}

Node replacement_of(const struct Graph *graph, const Node *replacements, Node symbol) {
  return replacements[graph->vertices[symbol].left];
}

static Node with_operands(struct Graph *graph, enum Operation operation, Node left, Node right) {
  switch (operation) {
  case ADD: return add(graph, left, right);
  case MULTIPLY: return multiply(graph, left, right);
  case POWER: return power(graph, left, right);
  default: return function(graph, operation, left, right);
  }
}

Node rebuild(const struct Rebuilding *rebuilding, Node node) {
  struct Graph *graph = rebuilding->graph;
  struct Cone *cone = cone_create();
  cone_collect(cone, graph, &node, 1);
  graph_work(graph, cone->work);
  Node *mapped = allocate(cone->count, sizeof *mapped);
  for (size_t index = 0; index < cone->count; index++) {
    const struct Vertex vertex = graph->vertices[cone->nodes[index]];
    int arity = operation_arity(vertex.operation);
    Node left = arity > 0 ? mapped[cone_slot(cone, vertex.left)] : ZERO;
    Node right = arity > 1 ? mapped[cone_slot(cone, vertex.right)] : ZERO, other = cone->nodes[index];
    bool is_replaced = arity > 0 && rebuilding->replace(rebuilding->context, vertex.operation, left, right, &other);
    mapped[index] = arity == 0 || is_replaced ? other : with_operands(graph, vertex.operation, left, right);
  }
  Node result = mapped[cone_slot(cone, node)];
  release(mapped);
  cone_release(cone);
  return result;
}

void substitute(struct Graph *graph, const Node *targets, size_t count, const Node *replacements, Node *results) {
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, targets, count);
  Node *mapped = allocate(cone->count, sizeof *mapped);
  for (size_t index = 0; index < cone->count; index++) {
    Node node = cone->nodes[index];
    const struct Vertex vertex = graph->vertices[node];
    int arity = operation_arity(vertex.operation);
    Node left = arity > 0 ? mapped[cone_slot(cone, vertex.left)] : ZERO;
    Node right = arity > 1 ? mapped[cone_slot(cone, vertex.right)] : ZERO;
    switch (vertex.operation) {
    case CONSTANT: mapped[index] = node; break;
    case SYMBOL: mapped[index] = replacements[vertex.left]; break;
    default: mapped[index] = with_operands(graph, vertex.operation, left, right); break;
    }
  }
  for (size_t i = 0; i < count; i++) results[i] = mapped[cone_slot(cone, targets[i])];
  release(mapped);
}

Node substitute_symbol(struct Graph *graph, Node node, Node symbol, Node by) {
  Node *replacements = own_symbols(graph), result = ZERO;
  replacements[graph->vertices[symbol].left] = by;
  substitute(graph, &node, 1, replacements, &result);
  release(replacements);
  return result;
}
