/* Small overdetermined systems of linear equations. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* A matrix whose rows end with their right sides. */
struct LeastSquares {
  size_t rows, columns;
  double *entries; /* rows x (columns + 1) */
};

/* Returns a system of zeros. */
struct LeastSquares least_squares_create(size_t rows, size_t columns);

/* Returns a row: `columns` coefficients and the right side. */
double *least_squares_row(const struct LeastSquares *system, size_t row);

/*
 * Solves the system; overwrites it. True if all equations hold to nine digits. Columns that depend on earlier ones get
 * the unknown 0; the first `needed` columns must be independent.
 */
bool least_squares_solve(struct LeastSquares *system, size_t needed, double *solution);
