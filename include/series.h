/*
 * Recurrences for the coefficients of Taylor series, for the code that lagc generates (A. Jorba, M. Zou: A software
 * package for the numerical integration of ODEs by means of high-order Taylor methods, 2005, section 2).
 *
 * a[j], b[j], ... are coefficients of t^j. Each function returns the coefficient k >= 1 of its result from those of its
 * operands up to k and those of the result below k. The order is bounded: all arrays hold SERIES_LENGTH elements.
 */
#ifndef SERIES_H
#define SERIES_H

#include <math.h>

enum { SERIES_LENGTH = 24 };

typedef double Series[SERIES_LENGTH];

/* For functions that are compiled anew for each order. */
#ifdef __GNUC__
#define SERIES_INLINE inline __attribute__((always_inline))
#else
#define SERIES_INLINE inline
#endif

/* (a b)_k */
static inline double series_product(int k, const double *a, const double *b) {
  double sum = 0.0;
  for (int j = 0; j <= k; j++) sum += a[j] * b[k - j];
  return sum;
}

/* (a b)_k without its first term a_0 b_k */
static inline double series_rest(int k, const double *a, const double *b) {
  double sum = 0.0;
  for (int j = 1; j <= k; j++) sum += a[j] * b[k - j];
  return sum;
}

/* (a a)_k: each pair of different coefficients stands twice in the sum. */
static inline double series_square(int k, const double *a) {
  double sum = 0.0;
  for (int j = 0; j <= (k - 1) / 2; j++) sum += a[j] * a[k - j];
  sum *= 2.0;
  return k % 2 == 0 ? sum + a[k / 2] * a[k / 2] : sum;
}

/* (a / b)_k, where top is a_k and c holds the quotient so far */
static inline double series_quotient(int k, double top, const double *b, const double *c) {
  double sum = 0.0;
  for (int j = 1; j <= k; j++) sum += b[j] * c[k - j];
  return (top - sum) / b[0];
}

/* (sqrt a)_k */
static inline double series_root(int k, const double *a, const double *c) {
  double sum = 0.0;
  for (int j = 1; j <= k - 1; j++) sum += c[j] * c[k - j];
  return (a[k] - sum) / (2.0 * c[0]);
}

/* (a^n)_k for any number n, with a_0 not 0 */
static inline double series_power(int k, double n, const double *a, const double *c) {
  double sum = 0.0;
  for (int j = 0; j <= k - 1; j++) sum += (n * (k - j) - j) * a[k - j] * c[j];
  return sum / (k * a[0]);
}

/* c' = a' b: c_k */
static inline double series_integral(int k, const double *a, const double *b) {
  double sum = 0.0;
  for (int j = 1; j <= k; j++) sum += j * a[j] * b[k - j];
  return sum * (1.0 / k);
}

/* The same with the series of a' in place of a. */
static inline double series_integral_of(int k, const double *rate, const double *b) {
  double sum = 0.0;
  for (int j = 0; j <= k - 1; j++) sum += rate[j] * b[k - 1 - j];
  return sum * (1.0 / k);
}

/* c' = a' / b: c_k, where top is a_k */
static inline double series_ratio_integral(int k, double top, const double *b, const double *c) {
  double sum = 0.0;
  for (int j = 1; j <= k - 1; j++) sum += j * c[j] * b[k - j];
  return (top - sum * (1.0 / k)) / b[0];
}

/* The coefficient k of atan2(y, x), with the series of x^2 + y^2 in b */
static inline double series_angle(int k, const double *y, const double *x, const double *b, const double *c) {
  double top = 0.0;
  for (int j = 1; j <= k; j++) top += j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return series_ratio_integral(k, top * (1.0 / k), b, c);
}

#endif
