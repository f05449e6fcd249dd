/* How a node is computed: by its operation in the graph, or by a fused operation that replaces two. */
#pragma once

#include "algebra/cone.h"

enum FusedKind {
  FUSED_SUM,
  FUSED_DIFFERENCE,
  FUSED_PRODUCT,
  FUSED_QUOTIENT,
  FUSED_NEGATION,
  FUSED_POWER,
  FUSED_FUNCTION
};

/* An operation with one or two operands, as it is computed. */
struct FusedOperation {
  enum FusedKind kind;
  Node left, right;
  int arity;
};

/*
 * The nodes needed for some targets, with use counts. Fetched nodes (symbols, numbers and parameter constants) are
 * members, but their operands are not.
 */
struct NeededNodes {
  const struct Graph *graph;
  struct Cone *cone;
  size_t *uses; /* uses of each member; being a target counts as 2, since its value is stored */
  size_t capacity;
  bool preparing; /* builds prepare(): expressions of parameters are computed, not fetched */
};

/* Returns an empty collection, which needs_collect() fills; needs_release() frees it. */
struct NeededNodes *needs_create(const struct Graph *graph);
void needs_release(struct NeededNodes *needs);

/* Collects the nodes that the targets need, in place of those collected before. */
void needs_collect(struct NeededNodes *needs, const Node *targets, size_t count, bool preparing);

/* True if the node is a symbol, a number or a parameter constant. */
bool is_fetched(const struct NeededNodes *needs, Node node);

/* Returns a member's operation, with a + (-b) fused into a - b, and a * (1 / b) into a / b if 1 / b has one use. */
struct FusedOperation fused_operation_of(const struct NeededNodes *needs, Node node);
