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

/* For functions that are compiled anew for each order; SERIES_ROLLED asks for one copy that serves all orders. */
#if defined(__GNUC__) && !defined(SERIES_ROLLED)
#define SERIES_INLINE inline __attribute__((always_inline))
#define SERIES_NOT_INLINE __attribute__((noinline, unused))
#define SERIES_IS_CONSTANT(n) __builtin_constant_p(n)
#else
#define SERIES_INLINE inline
#define SERIES_NOT_INLINE inline
#define SERIES_IS_CONSTANT(n) 0
#endif

/*
 * sum of a[j] b[-j] for j < n, b running backwards. The sum is a tree, so that few additions wait for one another and
 * rounding grows with the logarithm of n.
 */
static SERIES_INLINE double series_dot1(const double *a, const double *b) {
  return a[0] * b[0];
}

#define SERIES_DOT(n, half, rest)                                                                                      \
  static SERIES_INLINE double series_dot##n(const double *a, const double *b) {                                        \
    return series_dot##half(a, b) + series_dot##rest(a + (half), b - (half));                                          \
  }
SERIES_DOT(2, 1, 1)
SERIES_DOT(3, 2, 1)
SERIES_DOT(4, 2, 2)
SERIES_DOT(5, 3, 2)
SERIES_DOT(6, 3, 3)
SERIES_DOT(7, 4, 3)
SERIES_DOT(8, 4, 4)
SERIES_DOT(9, 5, 4)
SERIES_DOT(10, 5, 5)
SERIES_DOT(11, 6, 5)
SERIES_DOT(12, 6, 6)
SERIES_DOT(13, 7, 6)
SERIES_DOT(14, 7, 7)
SERIES_DOT(15, 8, 7)
SERIES_DOT(16, 8, 8)
SERIES_DOT(17, 9, 8)
SERIES_DOT(18, 9, 9)
SERIES_DOT(19, 10, 9)
SERIES_DOT(20, 10, 10)
SERIES_DOT(21, 11, 10)
SERIES_DOT(22, 11, 11)
SERIES_DOT(23, 12, 11)
SERIES_DOT(24, 12, 12)
#undef SERIES_DOT

static SERIES_INLINE double series_dot_by_size(int n, const double *a, const double *b) {
  switch (n) {
  case 1: return series_dot1(a, b);
  case 2: return series_dot2(a, b);
  case 3: return series_dot3(a, b);
  case 4: return series_dot4(a, b);
  case 5: return series_dot5(a, b);
  case 6: return series_dot6(a, b);
  case 7: return series_dot7(a, b);
  case 8: return series_dot8(a, b);
  case 9: return series_dot9(a, b);
  case 10: return series_dot10(a, b);
  case 11: return series_dot11(a, b);
  case 12: return series_dot12(a, b);
  case 13: return series_dot13(a, b);
  case 14: return series_dot14(a, b);
  case 15: return series_dot15(a, b);
  case 16: return series_dot16(a, b);
  case 17: return series_dot17(a, b);
  case 18: return series_dot18(a, b);
  case 19: return series_dot19(a, b);
  case 20: return series_dot20(a, b);
  case 21: return series_dot21(a, b);
  case 22: return series_dot22(a, b);
  case 23: return series_dot23(a, b);
  case 24: return series_dot24(a, b);
  default: return 0.0;
  }
}

/* One function for all orders, where the order is not known to the compiler. */
static SERIES_NOT_INLINE double series_dot_of_any_size(int n, const double *a, const double *b) {
  return series_dot_by_size(n, a, b);
}

static SERIES_INLINE double series_dot(int n, const double *a, const double *b) {
  return SERIES_IS_CONSTANT(n) ? series_dot_by_size(n, a, b) : series_dot_of_any_size(n, a, b);
}

/* (a b)_k */
static SERIES_INLINE double series_product(int k, const double *a, const double *b) {
  return series_dot(k + 1, a, b + k);
}

/* (a b)_k without its first term a_0 b_k */
static SERIES_INLINE double series_rest(int k, const double *a, const double *b) {
  return series_dot(k, a + 1, b + k - 1);
}

/* (a a)_k: each pair of different coefficients stands twice in the sum. */
static SERIES_INLINE double series_square(int k, const double *a) {
  double pairs = 2.0 * series_dot((k + 1) / 2, a, a + k);
  return k % 2 == 0 ? pairs + a[k / 2] * a[k / 2] : pairs;
}

/* (a / b)_k, where top is a_k, inverse is 1 / b_0 and c holds the quotient so far */
static SERIES_INLINE double series_quotient(int k, double top, double inverse, const double *b, const double *c) {
  return (top - series_rest(k, b, c)) * inverse;
}

/* (sqrt a)_k */
static SERIES_INLINE double series_root(int k, const double *a, const double *c) {
  return (a[k] - series_dot(k - 1, c + 1, c + k - 1)) / (2.0 * c[0]);
}

/* (a^n)_k for any number n, with a_0 not 0 */
static inline double series_power(int k, double n, const double *a, const double *c) {
  double sum = 0.0;
  for (int j = 0; j < k; j++) sum += (n * (k - j) - j) * a[k - j] * c[j];
  return sum / (k * a[0]);
}

/* c' = a' b: c_k, with the series of a' */
static SERIES_INLINE double series_integral(int k, const double *rate, const double *b) {
  return series_dot(k, rate, b + k - 1) * (1.0 / k);
}

/* c' = a' / b: c_k, where top is a_k */
static inline double series_ratio_integral(int k, double top, const double *b, const double *c) {
  double sum = 0.0;
  for (int j = 1; j < k; j++) sum += j * c[j] * b[k - j];
  return (top - sum / k) / b[0];
}

/* The coefficient k of atan2(y, x), with the series of x^2 + y^2 in b */
static inline double series_angle(int k, const double *y, const double *x, const double *b, const double *c) {
  double top = 0.0;
  for (int j = 1; j <= k; j++) top += j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return series_ratio_integral(k, top / k, b, c);
}

#endif
