/*
 * Gauss-Legendre quadrature: the sum of weight[i] f(node[i]) over n nodes is exact for polynomials of degree below 2 n.
 */
#pragma once

#include <stddef.h>

/* Most nodes of a rule. */
enum { QUADRATURE_LIMIT = 200 };

/*
 * Computes the nodes in (0, 1), ascending, and their weights; count is at most QUADRATURE_LIMIT. Takes O(count^2)
 * operations.
 */
void quadrature_rule(size_t count, double *nodes, double *weights);
