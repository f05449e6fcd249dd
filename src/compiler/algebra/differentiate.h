/*
 * Differentiation of the expression graph: forward sweeps for directions, one reverse sweep for a gradient. Each costs
 * as much as the targets have nodes below them, however large the graph is.
 */
#pragma once

#include "algebra/graph.h"

/* The partial derivatives of an operation with respect to its operands; by_right becomes ZERO for one operand. */
void partial_derivatives(struct Graph *graph, Node node, Node *by_left, Node *by_right);

/*
 * The derivative of each target along a direction: sum over symbols s of d target / d s * seeds[s].
 * seeds: one node for each symbol of the graph, ZERO where the direction has no part.
 */
void derivative_along(struct Graph *graph, const Node *targets, size_t count, const Node *seeds, Node *derivatives);

/* Derivatives along one direction that are known; empty where none is. */
struct Derivatives {
  Node *of; /* each node of the graph that is known */
  bool *is_known;
  size_t capacity;
};

/* The same for a direction along which derivatives are found again and again: those that are known cost nothing. */
void derivatives_find(struct Graph *graph, const Node *targets, size_t count, const Node *seeds,
                      struct Derivatives *known, Node *derivatives);

/* d target / d symbol; symbol is a SYMBOL node. */
Node derivative_by(struct Graph *graph, Node target, Node symbol);

/* The elements of a gradient that are not ZERO. */
struct Gradient {
  Node *symbols; /* SYMBOL nodes, ascending */
  Node *values;
  size_t count;
};

/* With respect to all symbols of the kinds (bit k: SymbolKind k). */
struct Gradient gradient_by_kinds(struct Graph *graph, Node target, unsigned kinds);

/* The same for sum over k of weights[k] * targets[k], with the weights held constant. */
struct Gradient weighted_gradient(struct Graph *graph, const Node *targets, const Node *weights, size_t count,
                                  unsigned kinds);

/* The gradient of target with respect to all symbols of one kind: element i belongs to the symbol with index i. */
void gradient_of(struct Graph *graph, Node target, enum SymbolKind kind, size_t count, Node *gradient);

/* The same for sum over k of weights[k] * targets[k], with the weights held constant. */
void weighted_gradient_of(struct Graph *graph, const Node *targets, const Node *weights, size_t target_count,
                          enum SymbolKind kind, size_t count, Node *gradient);

/* Each symbol of the graph for itself: replacements that change nothing yet. */
Node *own_symbols(const struct Graph *graph);

/* What stands for a symbol among replacements, or seeds, of all symbols. */
Node replacement_of(const struct Graph *graph, const Node *replacements, Node symbol);

/* The targets with each symbol s replaced by replacements[s] (one node for each symbol of the graph). */
void substitute(struct Graph *graph, const Node *targets, size_t count, const Node *replacements, Node *results);
