/* Quadrature by Gauss and Legendre: the sum of weight[i] f(node[i]) over n nodes is exact for polynomials of degree 2 n - 1. */
#pragma once

#include <stddef.h>

enum { QUADRATURE_LIMIT = 200 };

/* Sets the nodes in the interval from 0 to 1, ascending, and their weights, for a count up to the limit. */
void quadrature_rule(size_t count, double *nodes, double *weights);
