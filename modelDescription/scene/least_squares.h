/* Small systems of linear equations, more of them than unknowns. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Rows of a matrix, each with its right side behind it. */
struct LeastSquares {
  size_t rows, columns;
  double *entries; /* rows x (columns + 1) */
};

struct LeastSquares least_squares_create(size_t rows, size_t columns);

double *least_squares_row(const struct LeastSquares *system, size_t row);

/*
 * Whether all equations hold to nine digits, with the unknowns in solution. A column that follows from those before it has the
 * unknown 0; of the first few, needed, none may.
 */
bool least_squares_solve(struct LeastSquares *system, size_t needed, double *solution);
