#include <string.h>

#include "support/lu.h"

/* A pivot has lost its digits below this fraction of its value before the elimination, or of the subtracted terms. */
static const double smallest_pivot_share = 1e-14;

/* Elements of a triangle: L by rows with inverse pivots; then U by columns in the same pattern, without diagonal. */
static size_t element_count(void) {
  return (size_t)lagrangian.implicit.lu_pattern.start[lu_rows()];
}

static size_t sparse_size(size_t width) {
  return 2 * width * element_count();
}

static size_t sparse_slot(size_t row, size_t column) {
  const struct LuPattern *pattern = &lagrangian.implicit.lu_pattern;
  int i = pattern->slot[row], j = pattern->slot[column], low = i < j ? i : j;
  int k = pattern->start[i < j ? j : i];
  while (pattern->column[k] < low) k++;
  return (size_t)k + (i < j ? element_count() : 0);
}

/* Subtracts a[k] x[column[k]] from sum, for k from first to end - 1. */
static void subtract_products(size_t width, int first, int end, double *sum, const double *a, const double *x) {
  const int *column = lagrangian.implicit.lu_pattern.column;
  if (width == REAL)
    for (int k = first; k < end; k++) number_subtract_product(REAL, sum, a + k, x + column[k]);
  else
    for (int k = first; k < end; k++) number_subtract_product(COMPLEX, sum, a + 2 * k, x + 2 * (ptrdiff_t)column[k]);
}

static void copy_number(size_t width, double *to, const double *from) {
  memcpy(to, from, width * sizeof *to);
}

/*
 * Computes row i of L and column i of U: each solves a triangular system of the rows and columns before. row and column
 * hold them at their full indices during the call, and are 0 otherwise. False if the pivot is lost.
 */
static bool factor_row(size_t width, size_t i, double *l, double *u, double *row, double *column) {
  const struct LuPattern *pattern = &lagrangian.implicit.lu_pattern;
  int first = pattern->start[i], last = pattern->start[i + 1] - 1;
  double *pivot = l + width * (size_t)last, before = number_size(width, pivot), subtracted = 0.0;
  for (int k = first; k < last; k++) {
    size_t j = (size_t)pattern->column[k];
    int from = pattern->start[j], diagonal = pattern->start[j + 1] - 1;
    double *left = l + width * (size_t)k, *above = u + width * (size_t)k;
    subtract_products(width, from, diagonal, left, u, row);
    subtract_products(width, from, diagonal, above, l, column);
    number_multiply(width, left, l + width * (size_t)diagonal);
    number_subtract_product(width, pivot, left, above);
    subtracted += number_size(width, left) * number_size(width, above);
    copy_number(width, row + width * j, left);
    copy_number(width, column + width * j, above);
  }
  for (int k = first; k < last; k++) {
    size_t j = width * (size_t)pattern->column[k];
    memset(row + j, 0, width * sizeof *row);
    memset(column + j, 0, width * sizeof *column);
  }
  double least = smallest_pivot_share * (before + subtracted);
  if (!(before > least && number_size(width, pivot) > least) || !isfinite(least)) return false;
  number_invert(width, pivot);
  return true;
}

static bool sparse_factor(size_t width, double *matrix, double *work) {
  size_t n = lu_rows();
  memset(work, 0, 2 * width * n * sizeof *work);
  for (size_t i = 0; i < n; i++)
    if (!factor_row(width, i, matrix, matrix + width * element_count(), work, work + width * n)) return false;
  return true;
}

static void sparse_solve(size_t width, const double *factors, double *x, double *work) {
  const struct LuPattern *pattern = &lagrangian.implicit.lu_pattern;
  size_t n = lu_rows();
  const double *u = factors + width * element_count();
  for (size_t i = 0; i < n; i++) copy_number(width, work + width * (size_t)pattern->slot[i], x + width * i);
  for (size_t i = 0; i < n; i++)
    subtract_products(width, pattern->start[i], pattern->start[i + 1] - 1, work + width * i, factors, work);
  for (size_t i = n; i-- > 0;) {
    int first = pattern->start[i], last = pattern->start[i + 1] - 1;
    double *solved = work + width * i;
    number_multiply(width, solved, factors + width * (size_t)last);
    for (int k = first; k < last; k++)
      number_subtract_product(width, work + width * (size_t)pattern->column[k], u + width * (size_t)k, solved);
  }
  for (size_t i = 0; i < n; i++) copy_number(width, x + width * i, work + width * (size_t)pattern->slot[i]);
}

const struct Lu lu_sparse = {.size = sparse_size, .slot = sparse_slot, .factor = sparse_factor, .solve = sparse_solve};
