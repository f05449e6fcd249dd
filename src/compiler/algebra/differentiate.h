/*
 * Symbolic differentiation of the expression graph by the rules of automatic differentiation (A. Griewank, A. Walther:
 * Evaluating Derivatives, SIAM, 2008). The forward mode computes d y = sum of (d y / d x_i) d x_i from the operands up,
 * for one direction. The reverse mode computes adjoints from the targets down, for a gradient by all symbols at once.
 * Each is one sweep over the nodes below the targets, in numeric order, and adds at most a constant number of nodes for
 * each.
 */
#pragma once

#include "algebra/graph.h"

/* Returns the partial derivatives of an operation by its operands; by_right is ZERO for one operand. */
void partial_derivatives(struct Graph *graph, Node node, Node *by_left, Node *by_right);

/*
 * Computes the derivative of each target along a direction, the sum over symbols s of d target / d s * seeds[s]. seeds
 * has one element for each symbol of the graph, ZERO for those that do not change.
 */
void derivative_along(struct Graph *graph, const Node *targets, size_t count, const Node *seeds, Node *derivatives);

/* Known derivatives along one direction; zeros at first. */
struct Derivatives {
  Node *of; /* for each node of the graph */
  bool *is_known;
  size_t capacity;
};

/* Computes the same, and keeps the derivatives of all nodes below the targets in known, for the same seeds. */
void derivatives_find(struct Graph *graph, const Node *targets, size_t count, const Node *seeds,
                      struct Derivatives *known, Node *derivatives);

/* Returns d target / d symbol; symbol is a SYMBOL node. */
Node derivative_by(struct Graph *graph, Node target, Node symbol);

/* The nonzero elements of a gradient. */
struct Gradient {
  Node *symbols; /* SYMBOL nodes, ascending */
  Node *values;
  size_t count;
};

/* Returns the gradient by all symbols of the kinds (bit k: SymbolKind k). */
struct Gradient gradient_by_kinds(struct Graph *graph, Node target, unsigned kinds);

/* Returns the gradient of the sum over k of weights[k] * targets[k], at constant weights. */
struct Gradient weighted_gradient(struct Graph *graph, const Node *targets, const Node *weights, size_t count,
                                  unsigned kinds);

/* Computes the gradient by all symbols of one kind; element i belongs to the symbol with index i. */
void gradient_of(struct Graph *graph, Node target, enum SymbolKind kind, size_t count, Node *gradient);

/* Computes the gradient of the sum over k of weights[k] * targets[k], at constant weights. */
void weighted_gradient_of(struct Graph *graph, const Node *targets, const Node *weights, size_t target_count,
                          enum SymbolKind kind, size_t count, Node *gradient);

/* Returns the identity as replacements: each symbol for itself. */
Node *own_symbols(const struct Graph *graph);

/* Returns the element of a symbol in replacements or seeds. */
Node replacement_of(const struct Graph *graph, const Node *replacements, Node symbol);

/* Replaces operations, from the leaves on. */
struct Rebuilding {
  struct Graph *graph;
  void *context;
  /* Sets *result in place of an operation with rebuilt operands; false if the operation stays. */
  bool (*replace)(void *context, enum Operation operation, Node left, Node right, Node *result);
};

/* Returns the node with its operations replaced. `replace` may use the graph's cone. */
Node rebuild(const struct Rebuilding *rebuilding, Node node);

/* Replaces each symbol s in the targets by replacements[s]; one element for each symbol of the graph. */
void substitute(struct Graph *graph, const Node *targets, size_t count, const Node *replacements, Node *results);

/* Returns a node with one symbol replaced. */
Node substitute_symbol(struct Graph *graph, Node node, Node symbol, Node by);
