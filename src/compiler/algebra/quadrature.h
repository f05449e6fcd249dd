/*
 * Gauss-Legendre quadrature: the sum of weight[i] f(node[i]) over n nodes is exact for polynomials of degree below 2 n.
 */
#pragma once

#include <stddef.h>

/* Most nodes of a rule. */
enum { QUADRATURE_LIMIT = 200 };

/* Computes the nodes in (0, 1), ascending, and their weights, for 1 to QUADRATURE_LIMIT nodes, in O(count^2) steps. */
void quadrature_rule(size_t count, double *nodes, double *weights);
