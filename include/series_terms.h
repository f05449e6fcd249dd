/*
 * Coefficients that follow from the middle terms of sums, for one run or in lanes. The file that includes this one
 * defines SERIES_INLINE, series_middle(), and the recurrences without middle terms.
 */
#pragma once

#include "real.h"
#include "reciprocals.h"

/* Length of a series. Orders reach SERIES_LENGTH - 2: the state has one coefficient more than its derivative. */
enum { SERIES_LENGTH = 24 };

typedef Real Series[SERIES_LENGTH];

/*
 * Returns (a b)_k. b is the row that is computed later: its newest coefficient is used last. Here and below,
 * ..._around() takes the middle terms as an argument.
 */
static SERIES_INLINE Real series_product_around(Real middle, int k, const Real *a, const Real *b) {
  return (middle + a[k] * b[0]) + a[0] * b[k];
}

static SERIES_INLINE Real series_product(int k, const Real *a, const Real *b) {
  return series_product_around(series_middle(k, a + 1, b), k, a, b);
}

/* Returns (a b)_k without the term a_0 b_k. */
static SERIES_INLINE Real series_rest_around(Real middle, int k, const Real *a, const Real *b) {
  return middle + a[k] * b[0];
}

static SERIES_INLINE Real series_rest(int k, const Real *a, const Real *b) {
  return series_rest_around(series_middle(k, a + 1, b), k, a, b);
}

/* Returns (a a)_k. */
static SERIES_INLINE Real series_square_around(Real middle, int k, const Real *a) {
  return middle + 2.0 * (a[0] * a[k]);
}

/* Returns (a / b)_k; top is a_k, inverse is 1 / b_0, c the quotient's coefficients below k. */
static SERIES_INLINE Real series_quotient_around(Real middle, int k, Real top, Real inverse, const Real *b,
                                                 const Real *c) {
  return (top - (middle + b[k] * c[0])) * inverse;
}

static SERIES_INLINE Real series_quotient(int k, Real top, Real inverse, const Real *b, const Real *c) {
  return series_quotient_around(series_middle(k, b + 1, c), k, top, inverse, b, c);
}

/* Returns (sqrt a)_k; c holds the root's coefficients below k. The root of an identical 0 is 0. */
static SERIES_INLINE Real series_root_around(Real middle, int k, const Real *a, const Real *c) {
  return WHERE(BOTH(BOTH(c[0] == 0.0, c[k - 1] == 0.0), a[k] == 0.0), 0.0, (a[k] - middle) / (2.0 * c[0]));
}

static SERIES_INLINE Real series_root(int k, const Real *a, const Real *c) {
  return series_root_around(series_middle(k, c + 1, c), k, a, c);
}

/* Returns c_k of c' = a' b; rate holds the coefficients of a'. */
static SERIES_INLINE Real series_integral_around(Real middle, int k, const Real *rate, const Real *b) {
  return (middle + rate[k - 1] * b[0]) * reciprocal[k];
}

static SERIES_INLINE Real series_integral(int k, const Real *rate, const Real *b) {
  return series_integral_around(series_middle(k, rate, b), k, rate, b);
}

/* Returns |a|_k, on the piece that holds just after t = 0. */
static SERIES_INLINE Real series_absolute(int k, const Real *a) {
  return series_sign(k, a) * a[k];
}

/* Returns atan2(y, x)_k; b holds the coefficients of x^2 + y^2, c the angle's below k. */
static SERIES_INLINE Real series_angle(int k, const Real *y, const Real *x, const Real *b, const Real *c) {
  return series_ratio_integral(k, series_area(k, y, x), b, c);
}
