#include <string.h>

#include "support/lu.h"

/* The n pivot rows follow the n x n elements. */
static size_t dense_size(size_t width) {
  size_t n = lu_rows();
  return width * n * n + n;
}

static size_t dense_slot(size_t row, size_t column) {
  return row * lu_rows() + column;
}

/* Subtracts a b from sum, for count elements of sum and b. */
static void subtract_multiple(size_t width, size_t count, double *restrict sum, const double *a,
                              const double *restrict b) {
  if (width == REAL)
    for (size_t i = 0; i < count; i++) number_subtract_product(REAL, sum + i, a, b + i);
  else
    for (size_t i = 0; i < count; i++) number_subtract_product(COMPLEX, sum + 2 * i, a, b + 2 * i);
}

/* Returns the row, from k on, with the largest element in column k. */
static size_t pivot_row(size_t width, size_t n, const double *matrix, size_t k) {
  size_t best = k;
  for (size_t i = k + 1; i < n; i++)
    if (number_size(width, matrix + width * (i * n + k)) > number_size(width, matrix + width * (best * n + k)))
      best = i;
  return best;
}

static void swap(size_t count, double *a, double *b) {
  for (size_t i = 0; i < count && a != b; i++) {
    double kept = a[i];
    a[i] = b[i];
    b[i] = kept;
  }
}

static bool dense_factor(size_t width, double *matrix, double *work) {
  size_t n = lu_rows(), *pivots = (size_t *)(matrix + width * n * n);
  (void)work;
  for (size_t k = 0; k < n; k++) {
    double *row = matrix + width * k * n, *pivot = row + width * k;
    pivots[k] = pivot_row(width, n, matrix, k);
    swap(width * n, row, matrix + width * pivots[k] * n);
    double size = number_size(width, pivot);
    if (!(size > 0.0) || !isfinite(size)) return false;
    number_invert(width, pivot);
    for (size_t i = k + 1; i < n; i++) {
      double *factor = matrix + width * (i * n + k);
      if (number_size(width, factor) == 0.0) continue;
      number_multiply(width, factor, pivot);
      subtract_multiple(width, n - k - 1, factor + width, factor, pivot + width);
    }
  }
  return true;
}

static void dense_solve(size_t width, const double *factors, double *x, double *work) {
  size_t n = lu_rows();
  const size_t *pivots = (const size_t *)(factors + width * n * n);
  (void)work;
  for (size_t k = 0; k < n; k++) swap(width, x + width * k, x + width * pivots[k]);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++)
      number_subtract_product(width, x + width * i, factors + width * (i * n + j), x + width * j);
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++)
      number_subtract_product(width, x + width * i, factors + width * (i * n + j), x + width * j);
    number_multiply(width, x + width * i, factors + width * (i * n + i));
  }
}

const struct Lu lu_dense = {.size = dense_size, .slot = dense_slot, .factor = dense_factor, .solve = dense_solve};
