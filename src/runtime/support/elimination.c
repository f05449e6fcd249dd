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

bool solve_by_elimination(size_t n, double *rows, double least_pivot) {
  size_t width = n + 1;
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < n; i++)
      if (fabs(rows[i * width + k]) > fabs(rows[best * width + k])) best = i;
    if (!(fabs(rows[best * width + k]) > least_pivot)) return false;
    if (best != k) swap_equations(width, rows + k * width, rows + best * width);
    for (size_t i = 0; i < n; i++) {
      double share = i == k ? 0.0 : rows[i * width + k] / rows[k * width + k];
      for (size_t j = k; j < width; j++) rows[i * width + j] -= share * rows[k * width + j];
    }
  }
  for (size_t i = 0; i < n; i++) rows[i * width + n] /= rows[i * width + i];
  return true;
}
