/* Differentiation of the expression graph: forward sweeps for directions, one reverse sweep for a gradient. */
#ifndef DIFFERENTIATE_H
#define DIFFERENTIATE_H

#include "algebra/graph.h"

/*
 * The derivative of each target along a direction: sum over symbols s of d target / d s * seeds[s].
 * seeds: one node for each symbol of the graph, ZERO where the direction has no part.
 */
void derivative_along(struct Graph *graph, const Node *targets, size_t count, const Node *seeds, Node *derivatives);

/* d target / d symbol; symbol is a SYMBOL node. */
Node derivative_by(struct Graph *graph, Node target, Node symbol);

/* The gradient of target with respect to count SYMBOL nodes, by reverse accumulation. */
void gradient_of(struct Graph *graph, Node target, const Node *symbols, size_t count, Node *gradient);

/* The same for sum over k of weights[k] * targets[k], with the weights held constant. */
void weighted_gradient_of(struct Graph *graph, const Node *targets, const Node *weights, size_t target_count,
                          const Node *symbols, size_t count, Node *gradient);

/* The targets with each symbol s replaced by replacements[s] (one node for each symbol of the graph). */
void substitute(struct Graph *graph, const Node *targets, size_t count, const Node *replacements, Node *results);

#endif
