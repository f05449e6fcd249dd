#include "program/codegen/fused_operations.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "program/codegen/parameter_constants.h"

struct NeededNodes *needs_create(const struct Graph *graph) {
  struct NeededNodes *needs = allocate(1, sizeof *needs);
  needs->graph = graph;
  needs->cone = cone_create();
  return needs;
}

void needs_release(struct NeededNodes *needs) {
  cone_release(needs->cone);
  release(needs->uses);
  release(needs);
}

static bool is_leaf(const struct Graph *graph, Node node) {
  return operation_arity(graph->vertices[node].operation) == 0;
}

bool is_fetched(const struct NeededNodes *needs, Node node) {
  return is_leaf(needs->graph, node) || (!needs->preparing && is_of_parameters(needs->graph, node));
}

static enum Visit visit_motion(void *context, const struct Graph *graph, Node node) {
  (void)context;
  return is_of_parameters(graph, node) ? VISIT_NOTHING_BELOW : VISIT_OPERANDS;
}

void needs_collect(struct NeededNodes *needs, const Node *targets, size_t count, bool preparing) {
  const struct Graph *graph = needs->graph;
  struct Cone *cone = needs->cone;
  needs->preparing = preparing;
  cone_collect_part(cone, graph, targets, count, preparing ? NULL : visit_motion, NULL);
  if (cone->count > needs->capacity) {
    needs->capacity = 2 * cone->count;
    needs->uses = reallocate(needs->uses, needs->capacity, sizeof *needs->uses);
  }
  for (size_t i = 0; i < cone->count; i++) needs->uses[i] = 0;
  for (size_t i = 0; i < count; i++) needs->uses[cone_slot(cone, targets[i])] += 2;
  for (size_t i = 0; i < cone->count; i++) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[i]];
    if (is_fetched(needs, cone->nodes[i])) continue;
    needs->uses[cone_slot(cone, vertex->left)]++;
    if (operation_arity(vertex->operation) == 2) needs->uses[cone_slot(cone, vertex->right)]++;
  }
}

static bool is_inverse_for_one(const struct NeededNodes *needs, Node node) {
  const struct Vertex *vertex = &needs->graph->vertices[node];
  return !is_fetched(needs, node) && vertex->operation == POWER && graph_is_constant(needs->graph, vertex->right) &&
         graph_value(needs->graph, vertex->right) == -1.0 && needs->uses[cone_slot(needs->cone, node)] == 1;
}

static bool is_negation(const struct NeededNodes *needs, Node node) {
  Node base;
  return !is_fetched(needs, node) && coefficient_of(needs->graph, node, &base) == -1.0;
}

struct FusedOperation fused_operation_of(const struct NeededNodes *needs, Node node) {
  const struct Vertex *vertices = needs->graph->vertices, *vertex = &vertices[node];
  Node left = vertex->left, right = vertex->right;
  switch (vertex->operation) {
  case ADD:
    if (is_negation(needs, right)) return (struct FusedOperation){FUSED_DIFFERENCE, left, vertices[right].right, 2};
    if (is_negation(needs, left)) return (struct FusedOperation){FUSED_DIFFERENCE, right, vertices[left].right, 2};
    return (struct FusedOperation){FUSED_SUM, left, right, 2};
  case MULTIPLY:
    if (is_negation(needs, node)) return (struct FusedOperation){FUSED_NEGATION, right, ZERO, 1};
    if (is_inverse_for_one(needs, right)) return (struct FusedOperation){FUSED_QUOTIENT, left, vertices[right].left, 2};
    if (is_inverse_for_one(needs, left)) return (struct FusedOperation){FUSED_QUOTIENT, right, vertices[left].left, 2};
    return (struct FusedOperation){FUSED_PRODUCT, left, right, 2};
  case POWER: return (struct FusedOperation){FUSED_POWER, left, right, 2};
  default: return (struct FusedOperation){FUSED_FUNCTION, left, right, operation_arity(vertex->operation)};
  }
}
