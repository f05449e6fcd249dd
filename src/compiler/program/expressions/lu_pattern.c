/*
 * Sparse LU for implicit methods. The stage systems of Radau IIA, with the coordinates eliminated, have the matrices
 *
 *     mu^2 - mu df/dv - df/dq
 *
 * for several complex mu, where f are the accelerations; rows of first-order states have mu in place of mu^2. All
 * share one pattern: the elements of df/dv and df/dq, made symmetric, and the diagonal. A minimum-degree elimination
 * (mechanics/mass_matrix/elimination.h) gives the order and the fill-in. T. A. Davis: Direct Methods for Sparse Linear
 * Systems, 2006, chapter 7.
 */
#include "program/expressions/lu_pattern.h"

#include <stdlib.h>

#include "base/memory.h"

/* Finds the positions in the lower triangle of the symmetric pattern, each once and sorted. Returns their number. */
static size_t find_positions(const struct JacobianExpressions *jacobian, size_t coordinates, size_t rows,
                             struct Position *positions) {
  size_t found = 0, count = 0;
  for (size_t column = 0; column < coordinates + rows; column++) {
    for (size_t e = jacobian->start[column]; e < jacobian->start[column + 1]; e++) {
      if (jacobian->row[e] < coordinates) continue;
      size_t i = jacobian->row[e] - coordinates, j = column < coordinates ? column : column - coordinates;
      positions[found++] = (struct Position){i < j ? j : i, i < j ? i : j};
    }
  }
  for (size_t i = 0; i < rows; i++) positions[found++] = (struct Position){i, i};
  qsort(positions, found, sizeof *positions, compare_positions);
  for (size_t i = 0; i < found; i++)
    if (i == 0 || compare_positions(&positions[i - 1], &positions[i]) != 0) positions[count++] = positions[i];
  return count;
}

/* True if sparse factors are cheaper. Measured on chains of masses, springs and dampers. */
static bool is_sparse(const struct Elimination *pattern, size_t rows) {
  return rows >= 16 && pattern->start[rows] <= rows * rows / 6;
}

struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates, size_t rows) {
  struct Position *positions = allocate(jacobian->count + rows, sizeof *positions);
  struct Elimination *pattern = allocate(1, sizeof *pattern);
  *pattern = eliminate(graph, rows, rows, positions, find_positions(jacobian, coordinates, rows, positions));
  return is_sparse(pattern, rows) ? pattern : NULL;
}
