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
static double take_largest_pivot(size_t n, size_t k, double *rows, size_t *order) {
  size_t width = n + 1, best = k;
  for (size_t i = k + 1; i < n; i++)
    if (fabs(rows[i * width + k]) > fabs(rows[best * width + k])) best = i;
  if (best != k) {
    swap_equations(width, rows + k * width, rows + best * width);
    if (order != NULL) {
      size_t equation = order[k];
      order[k] = order[best];
      order[best] = equation;
    }
  }
  return fabs(rows[k * width + k]);
}

/* Solves the triangular equations that elimination leaves; the solution replaces the right sides, stride numbers apart. */
static void substitute_back(size_t n, const double *rows, double *right, size_t stride) {
  for (size_t i = n; i-- > 0;) {
    const double *row = rows + i * (n + 1);
    double sum = right[i * stride];
    for (size_t j = i + 1; j < n; j++) sum -= row[j] * right[j * stride];
    right[i * stride] = sum / row[i];
  }
}

/* Each row keeps its multiples of earlier ones in front of its pivot. */
bool eliminate(size_t n, double *rows, double least_pivot, size_t *order) {
  size_t width = n + 1;
  for (size_t i = 0; i < n && order != NULL; i++) order[i] = i;
  for (size_t k = 0; k < n; k++) {
    if (!(take_largest_pivot(n, k, rows, order) > least_pivot)) return false;
    const double *pivot = rows + k * width;
    for (size_t i = k + 1; i < n; i++) {
      double *row = rows + i * width, share = row[k] / pivot[k];
      for (size_t j = k + 1; j < width && share != 0.0; j++) row[j] -= share * pivot[j];
      row[k] = share;
    }
  }
  return true;
}

bool solve_by_elimination(size_t n, double *rows, double least_pivot) {
  if (!eliminate(n, rows, least_pivot, NULL)) return false;
  substitute_back(n, rows, rows + n, n + 1);
  return true;
}

void solve_eliminated(size_t n, const double *rows, const size_t *order, const double *right, double *solution) {
  for (size_t i = 0; i < n; i++) {
    solution[i] = right[order[i]];
    for (size_t j = 0; j < i; j++) solution[i] -= rows[i * (n + 1) + j] * solution[j];
  }
  substitute_back(n, rows, solution, 1);
}
