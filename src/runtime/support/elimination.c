#include "support/elimination.h"

#include <math.h>

#include "arithmetic.h"

static void swap_equations(size_t width, double *one, double *other) {
  for (size_t j = 0; j < width; j++) {
    double number = one[j];
    one[j] = other[j];
    other[j] = number;
  }
}

/* Exchanges equation k with that of the largest pivot among the further ones. Returns its size. */
static double take_largest_pivot(size_t n, size_t k, double *rows) {
  size_t width = n + 1, best = k;
  for (size_t i = k + 1; i < n; i++)
    if (fabs(rows[i * width + k]) > fabs(rows[best * width + k])) best = i;
  if (best != k) swap_equations(width, rows + k * width, rows + best * width);
  return fabs(rows[k * width + k]);
}

/* Solves the triangular equations that elimination leaves; the solution replaces the right sides. */
static void substitute_back(size_t n, double *rows) {
  size_t width = n + 1;
  for (size_t i = n; i-- > 0;) {
    double sum = rows[i * width + n];
    for (size_t j = i + 1; j < n; j++) sum -= rows[i * width + j] * rows[j * width + n];
    rows[i * width + n] = sum / rows[i * width + i];
  }
}

bool solve_by_elimination(size_t n, double *rows, double least_pivot) {
  size_t width = n + 1;
  for (size_t k = 0; k < n; k++) {
    if (!(take_largest_pivot(n, k, rows) > least_pivot)) return false;
    const double *pivot = rows + k * width;
    for (size_t i = k + 1; i < n; i++) {
      double *row = rows + i * width, share = row[k] / pivot[k];
      for (size_t j = k + 1; j < width && share != 0.0; j++) row[j] -= share * pivot[j];
    }
  }
  substitute_back(n, rows);
  return true;
}
