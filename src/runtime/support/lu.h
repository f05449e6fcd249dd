/*
 * LU factorization of matrices with a row and a column for each velocity and each further state, for implicit methods.
 * Elements are real or complex (number.h). lagc chooses the cheaper form for a system, lagrangian.implicit.lu, and an
 * FMU links that one.
 */
#pragma once

#include "lagrangian.h"
#include "support/number.h"

/* Returns the number of rows: velocities and further states. */
static inline size_t lu_rows(void) {
  return lagrangian.state_count - lagrangian.coordinate_count;
}

/* A form of the factorization. width: REAL or COMPLEX of number.h. */
struct Lu {
  /* Returns the doubles that a matrix, and later its factors, takes. */
  size_t (*size)(size_t width);
  /* Returns the index of the element in this row and column. */
  size_t (*slot)(size_t row, size_t column);
  /* Replaces a matrix by its factors. work: two numbers per row. False if the matrix is singular to rounding. */
  bool (*factor)(size_t width, double *matrix, double *work);
  /* Replaces the right side x by the solution. work: one number per row. */
  void (*solve)(size_t width, const double *factors, double *x, double *work);
};

/* Dense, by rows, with partial pivoting: about n^3 / 3 multiplications. */
extern const struct Lu lu_dense;

/*
 * Sparse, in the pattern lagrangian.implicit.lu_pattern, whose elimination order is fixed: the pivots are those on the
 * diagonal.
 *
 * A matrix whose pivot has lost its digits counts as singular, as may happen for a long step; for short steps, mu^2
 * dominates the diagonal. With dampers and springs, M (mu + damping + stiffness / mu) has a positive definite real part
 * for each mu of Radau IIA, and needs no other pivots (R. Mathias: Matrices with positive definite Hermitian part, SIAM
 * Journal on Matrix Analysis and Applications 13, 1992).
 */
extern const struct Lu lu_sparse;
