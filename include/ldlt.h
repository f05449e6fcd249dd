/*
 * M = L D L^T of a symmetric positive definite matrix that is stored by rows of its lower triangle, in the pattern of L:
 * row i has elements start[i] .. start[i + 1] - 1, at ascending columns, the diagonal last; M is 0 where L fills in.
 * start and column are NULL for a full matrix, whose row i begins at i (i + 1) / 2. For mass matrix blocks too large for
 * straight-line code.
 */
#ifndef LDLT_H
#define LDLT_H

#include <math.h>
#include <stddef.h>

#include "arithmetic.h"
#include "real.h"

/* Replaces M by L (below the diagonal) and D (on it). Returns 0, or 1 + the row in which M is not definite. */
size_t ldlt_factor(size_t n, const size_t *start, const size_t *column, Real *m);

/*
 * The sum of L_ik D_k L_jk over the columns k < j that rows i and j share, from L in the columns of row j and L D in those
 * of row i; place: where row i has column j.
 */
Real ldlt_product_of_rows(const size_t *start, const size_t *column, const Real *m, size_t i, size_t place);

/* Whether the row of a pivot has no part in anything: it is infinite, as that of an open contact, and 0 is found for its number. */
static inline bool ldlt_is_idle(Real pivot) {
  Condition has_part = pivot != -INFINITY;
  return !ANYWHERE(has_part);
}

/* Solves L D L^T x = b in place, with the result of ldlt_factor(). */
void ldlt_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x);

#endif
