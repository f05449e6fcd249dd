/*
 * Factors M = L D L^T of a symmetric positive definite matrix without pivoting, for blocks of the mass matrix that are
 * too large for straight-line code (G. H. Golub, C. F. Van Loan: Matrix Computations, section 4.1). It costs n^3 / 6
 * multiplications for a full matrix, fewer in a sparse pattern.
 *
 * M is stored by rows of its lower triangle, in the pattern of L: row i has elements start[i] .. start[i + 1] - 1, at
 * ascending columns, the diagonal last. M is 0 at fill-in. start and column are NULL for a full matrix, whose row i
 * begins at i (i + 1) / 2.
 */
#ifndef LDLT_H
#define LDLT_H

#include <math.h>
#include <stddef.h>

#include "arithmetic.h"
#include "real.h"

/* Replaces M by L (below the diagonal) and D (on it). Returns 0, or 1 + the first row whose pivot is not positive. */
size_t ldlt_factor(size_t n, const size_t *start, const size_t *column, Real *m);

/* True if the row of a pivot is inactive in all lanes: the pivot is -INFINITY, as that of an open contact. */
static inline bool ldlt_is_idle(Real pivot) {
  Condition has_part = pivot != -INFINITY;
  return !ANYWHERE(has_part);
}

/* Solves L D L^T x = b in place, with the result of ldlt_factor(). */
void ldlt_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x);

#endif
