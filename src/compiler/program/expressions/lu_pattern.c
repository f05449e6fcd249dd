#include "program/expressions/lu_pattern.h"

#include <stdlib.h>

#include "base/memory.h"

/* Where stiffness or damping couples two coordinates, in the lower triangle, each position once. Returns the count. */
static size_t find_positions(const struct JacobianExpressions *jacobian, size_t coordinates,
                             struct Position *positions) {
  size_t found = 0, count = 0;
  for (size_t column = 0; column < 2 * coordinates; column++) {
    for (size_t e = jacobian->start[column]; e < jacobian->start[column + 1]; e++) {
      if (jacobian->row[e] < coordinates || jacobian->row[e] >= 2 * coordinates) continue;
      size_t i = jacobian->row[e] - coordinates, j = column % coordinates;
      positions[found++] = (struct Position){i < j ? j : i, i < j ? i : j};
    }
  }
  for (size_t i = 0; i < coordinates; i++) positions[found++] = (struct Position){i, i};
  qsort(positions, found, sizeof *positions, compare_positions);
  for (size_t i = 0; i < found; i++)
    if (i == 0 || compare_positions(&positions[i - 1], &positions[i]) != 0) positions[count++] = positions[i];
  return count;
}

/* For rows of masses, springs and dampers, sparse factors were measured to be faster from 15 masses on. */
static bool is_sparse(const struct Elimination *pattern, size_t coordinates) {
  return coordinates >= 16 && pattern->start[coordinates] <= coordinates * coordinates / 6;
}

struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates) {
  struct Position *positions = allocate(jacobian->count + coordinates, sizeof *positions);
  struct Elimination *pattern = allocate(1, sizeof *pattern);
  *pattern = eliminate(graph, coordinates, coordinates, positions, find_positions(jacobian, coordinates, positions));
  return is_sparse(pattern, coordinates) ? pattern : NULL;
}
