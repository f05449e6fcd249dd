/* Rounding error bounds of expressions. */
#ifndef ROUNDING_BOUNDS_H
#define ROUNDING_BOUNDS_H

#include "algebra/graph.h"

/*
 * Computes first-order bounds of the rounding errors of the targets, in units of the relative rounding error, by
 * running error analysis (N. J. Higham: Accuracy and Stability of Numerical Algorithms, SIAM, 2002, section 3.3):
 * E(f(x, y)) = |f_x| E(x) + |f_y| E(y) + |f|. Symbols count as exact.
 */
void rounding_bounds_of(struct Graph *graph, const Node *targets, size_t count, Node *rounding_bounds);

#endif
