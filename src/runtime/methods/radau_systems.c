#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "methods/radau.h"
#include "support/lu.h"

static size_t width_of(int j) {
  return j == 0 ? REAL : COMPLEX;
}

void radau_systems_take(struct RadauSystems *systems, struct Arena *arena) {
  ARENA_TAKE(arena, systems->slot, lagrangian.implicit.pattern.count);
  ARENA_TAKE(arena, systems->diagonal, lu_rows());
  for (int j = 0; j < SYSTEM_LIMIT; j++)
    ARENA_NUMBERS(arena, lagrangian.implicit.lu->size(width_of(j)), &systems->factors[j]);
  ARENA_TAKE(arena, systems->right_side, lagrangian.state_count);
  ARENA_TAKE(arena, systems->solution, lagrangian.state_count);
  ARENA_NUMBERS(arena, 2 * COMPLEX * lu_rows(), &systems->work);
}

/* The derivative by a velocity shares the offset of that by its coordinate. */
void radau_systems_find_slots(struct RadauSystems *systems) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  size_t n = lagrangian.coordinate_count;
  for (size_t i = 0; i < lu_rows(); i++) systems->diagonal[i] = lagrangian.implicit.lu->slot(i, i);
  for (size_t column = 0; column < lagrangian.state_count; column++)
    for (int e = pattern->start[column]; e < pattern->start[column + 1]; e++)
      if ((size_t)pattern->row[e] >= n)
        systems->slot[e] = lagrangian.implicit.lu->slot((size_t)pattern->row[e] - n, column < n ? column : column - n);
}

bool radau_systems_evaluate(struct Instance *instance, struct RadauSystems *systems, double time, const double *state) {
  if (!solver_jacobian(instance, time, state, systems->values)) return false;
  for (size_t e = 0; e < lagrangian.implicit.pattern.count; e++)
    if (!isfinite(systems->values[e])) systems->values[e] = 0.0;
  return true;
}

/* Fills the matrix of the system for mu (radau.h). */
static void fill(const struct RadauSystems *systems, size_t width, const double *mu, double *matrix) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  size_t n = lagrangian.coordinate_count;
  memset(matrix, 0, lagrangian.implicit.lu->size(width) * sizeof *matrix);
  for (size_t i = 0; i < n; i++) number_add_product(width, matrix + width * systems->diagonal[i], mu, mu);
  for (size_t i = n; i < lu_rows(); i++)
    for (size_t k = 0; k < width; k++) matrix[width * systems->diagonal[i] + k] += mu[k];
  for (size_t column = 0; column < lagrangian.state_count; column++) {
    bool is_velocity = column >= n && column < 2 * n;
    for (int e = pattern->start[column]; e < pattern->start[column + 1]; e++) {
      if ((size_t)pattern->row[e] < n) continue;
      double *element = matrix + width * systems->slot[e];
      if (!is_velocity) element[0] -= systems->values[e];
      else
        for (size_t i = 0; i < width; i++) element[i] -= systems->values[e] * mu[i];
    }
  }
}

bool radau_systems_factor(struct RadauSystems *systems, const struct RadauMethod *method, double step) {
  for (int j = 0; j <= method->stages / 2; j++) {
    systems->mu[j] = (struct Complex){method->value_real[j] / step, method->value_imaginary[j] / step};
    fill(systems, width_of(j), &systems->mu[j].real, systems->factors[j]);
    if (!lagrangian.implicit.lu->factor(width_of(j), systems->factors[j], systems->work)) return false;
  }
  return true;
}

/* Subtracts J's columns of the velocities, in the rows below the coordinates, times x from sum. */
static void subtract_velocities(const struct RadauSystems *systems, size_t width, const double *x, double *sum) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  size_t n = lagrangian.coordinate_count;
  for (size_t column = n; column < 2 * n; column++) {
    for (int e = pattern->start[column]; e < pattern->start[column + 1]; e++) {
      size_t row = (size_t)pattern->row[e];
      if (row < n) continue;
      for (size_t i = 0; i < width; i++) sum[width * (row - n) + i] -= systems->values[e] * x[width * (column - n) + i];
    }
  }
}

/* Solves system j for right: eliminates the velocities, solves, and recovers them. width: numbers in an element. */
static void solve_system(const struct RadauSystems *systems, int j, size_t width, const double *right,
                         double *solution) {
  size_t n = lagrangian.coordinate_count, rows = lu_rows();
  const double *mu = &systems->mu[j].real;
  memcpy(solution, right + width * n, width * rows * sizeof *solution);
  for (size_t i = 0; i < n; i++) number_add_product(width, solution + width * i, mu, right + width * i);
  subtract_velocities(systems, width, right, solution);
  lagrangian.implicit.lu->solve(width, systems->factors[j], solution, systems->work);
  double *velocity = solution + width * n;
  memmove(velocity + width * n, velocity, width * (rows - n) * sizeof *velocity);
  for (size_t i = 0; i < width * n; i++) velocity[i] = -right[i];
  for (size_t i = 0; i < n; i++) number_add_product(width, velocity + width * i, mu, solution + width * i);
}

void radau_systems_solve(struct RadauSystems *systems, int j) {
  size_t states = lagrangian.state_count;
  double *right = (double *)systems->right_side, *solution = (double *)systems->solution;
  if (width_of(j) == COMPLEX) {
    solve_system(systems, j, COMPLEX, right, solution);
    return;
  }
  for (size_t i = 0; i < states; i++) right[i] = right[2 * i];
  solve_system(systems, j, REAL, right, solution);
  for (size_t i = states; i-- > 0;) systems->solution[i] = (struct Complex){solution[i], 0.0};
}
