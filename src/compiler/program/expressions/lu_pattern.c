#include "program/expressions/lu_pattern.h"

#include <stdlib.h>

#include "base/memory.h"

/*
 * Where a matrix of Radau IIA has elements, in the lower triangle, each position once: its rows are those of the velocities and of the
 * states behind them, its columns those of the coordinates and these states. Returns the count.
 */
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

/* For rows of masses, springs and dampers, sparse factors were measured to be faster from 15 masses on. */
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
