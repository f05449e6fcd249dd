/*
 * Matrices with a row and a column for each velocity and each state behind them, factored as L U, for implicit methods: of real or complex
 * numbers (number.h). lagc chooses what is cheaper for a system, lagrangian.implicit.lu, and an FMU links that alone.
 */
#ifndef LU_H
#define LU_H

#include "lagrangian.h"
#include "support/number.h"

static inline size_t lu_rows(void) {
  return lagrangian.state_count - lagrangian.coordinate_count;
}

struct Lu {
  /* Doubles that a matrix takes, and its factors. */
  size_t (*size)(size_t width);
  /* Which of the matrix's numbers is the element in this row and column. */
  size_t (*place)(size_t row, size_t column);
  /* Turns a matrix into its factors; work holds two numbers a row. False where it is singular to rounding. */
  bool (*factor)(size_t width, double *matrix, double *work);
  /* Turns the right side x into the solution; work holds a number a row. */
  void (*solve)(size_t width, const double *factors, double *x, double *work);
};

/* By rows, with row pivots. */
extern const struct Lu lu_dense;

/*
 * In lagrangian.implicit.lu_pattern, whose order is fixed: pivots are those on the diagonal. Where a pivot has lost its digits,
 * the matrix counts as singular, as it may be for a long step; for short ones, mu^2 in the diagonal dominates. With
 * dampers and springs, M (mu + damping + stiffness / mu) has a positive definite real part for each mu of Radau IIA,
 * and needs no other pivots (R. Mathias: Matrices with positive definite Hermitian part, SIAM Journal on Matrix
 * Analysis and Applications 13, 1992).
 */
extern const struct Lu lu_sparse;

#endif
