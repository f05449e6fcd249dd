#include "planes/pivoting.h"

#include <math.h>

#include "arithmetic.h"

void pivoting_begin(const struct Pivoting *pivoting) {
  for (size_t j = 0; j < pivoting->columns; j++) pivoting->order[j] = (double)j;
}

static void swap_numbers(double *a, double *b) {
  double other = *a;
  *a = *b;
  *b = other;
}

double pivoting_take(const struct Pivoting *pivoting, size_t k, size_t *row) {
  size_t n = pivoting->columns, column = k;
  double *a = pivoting->matrix;
  *row = k;
  for (size_t i = k; i < pivoting->rows; i++)
    for (size_t j = k; j < n; j++)
      if (fabs(a[i * n + j]) > fabs(a[*row * n + column])) {
        *row = i;
        column = j;
      }
  for (size_t j = 0; j < n && *row != k; j++) swap_numbers(&a[*row * n + j], &a[k * n + j]);
  for (size_t i = 0; i < pivoting->rows && column != k; i++) swap_numbers(&a[i * n + column], &a[i * n + k]);
  swap_numbers(&pivoting->order[column], &pivoting->order[k]);
  return fabs(a[k * n + k]);
}
