/* Arithmetic for code that serves real and complex elements: of width doubles, the real and the imaginary part. */
#pragma once

#include <math.h>
#include <stddef.h>

/* Widths: doubles in an element. */
enum { REAL = 1, COMPLEX = 2 };

/* Returns the magnitude; of a complex number the sum of those of its parts. */
static inline double number_size(size_t width, const double *a) {
  return width == REAL ? fabs(a[0]) : fabs(a[0]) + fabs(a[1]);
}

/* Adds a b to sum. */
static inline void number_add_product(size_t width, double *sum, const double *a, const double *b) {
  if (width == REAL) {
    sum[0] += a[0] * b[0];
  } else {
    sum[0] += a[0] * b[0] - a[1] * b[1];
    sum[1] += a[0] * b[1] + a[1] * b[0];
  }
}

/* Subtracts a b from sum. */
static inline void number_subtract_product(size_t width, double *sum, const double *a, const double *b) {
  if (width == REAL) {
    sum[0] -= a[0] * b[0];
  } else {
    sum[0] -= a[0] * b[0] - a[1] * b[1];
    sum[1] -= a[0] * b[1] + a[1] * b[0];
  }
}

/* Replaces a by a b. */
static inline void number_multiply(size_t width, double *a, const double *b) {
  double product[COMPLEX] = {0.0, 0.0};
  number_add_product(width, product, a, b);
  a[0] = product[0];
  if (width == COMPLEX) a[1] = product[1];
}

/* Replaces a by 1 / a. */
static inline void number_invert(size_t width, double *a) {
  if (width == REAL) {
    a[0] = 1.0 / a[0];
  } else {
    double square = a[0] * a[0] + a[1] * a[1];
    a[0] /= square;
    a[1] /= -square;
  }
}
