/*
 * M = L D L^T of a symmetric positive definite matrix in packed storage: row i of the lower triangle starts at
 * i (i + 1) / 2. For mass matrix blocks too large for straight-line code.
 */
#ifndef LDLT_H
#define LDLT_H

#include <stddef.h>

/* Replaces M by L (below the diagonal) and D (on it). Returns 0, or 1 + the row in which M is not definite. */
size_t ldlt_factor(size_t n, double *m);

/* Solves L D L^T x = b in place, with the result of ldlt_factor(). */
void ldlt_solve(size_t n, const double *m, double *x);

#endif
