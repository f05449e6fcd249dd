/* The recurrences of include/series.h for lanes, under the same names and include guard, so that it replaces them. */
#ifndef SERIES_H
#define SERIES_H

#include "lane_real.h"
#include "reciprocals.h"

/* Coefficients of a series, as in include/series.h. */
enum { SERIES_LENGTH = 24 };

typedef Real Series[SERIES_LENGTH];

/* Returns the sum of a[j] b[-j] for j < n; the additions form one chain, beside which other sums run. */
LANES_INLINE Lanes series_dot(int n, const Lanes *a, const Lanes *b) {
  Lanes sum = {0};
  for (int j = 0; j < n; j++) sum += a[j] * b[-j];
  return sum;
}

/* Returns the sum of a_j b_(k-j) without the ends j = 0 and j = k. */
LANES_INLINE Lanes series_middle(int k, const Lanes *a, const Lanes *b) {
  return series_dot(k - 1, a + 1, b + k - 1);
}

/* Computes the middle terms m[i] of all products of an order. */
#define SERIES_MIDDLES(PRODUCTS) PRODUCTS(SERIES_MIDDLE)
#define SERIES_MIDDLE(i, a, from, b) m[i] = series_dot(k - 1, (a) + (from), (b) + k - 1);

struct SeriesFactors {
  const Lanes *a, *b;
};
#define SERIES_FACTORS(a, from, b) {(a) + (from), (b)},

LANES_INLINE void series_middles(int k, size_t count, const struct SeriesFactors *factors, Lanes *m) {
  for (size_t i = 0; i < count; i++) m[i] = series_dot(k - 1, factors[i].a, factors[i].b + k - 1);
}

/*
 * (a b)_k, where b is the row that is computed later, so that its newest coefficient is added last. Here and below,
 * ..._around() gets the middle terms.
 */
LANES_INLINE Lanes series_product_around(Lanes middle, int k, const Lanes *a, const Lanes *b) {
  return (middle + a[k] * b[0]) + a[0] * b[k];
}

LANES_INLINE Lanes series_product(int k, const Lanes *a, const Lanes *b) {
  return series_product_around(series_middle(k, a, b), k, a, b);
}

/* Returns (a b)_k without its first term a_0 b_k. */
LANES_INLINE Lanes series_rest_around(Lanes middle, int k, const Lanes *a, const Lanes *b) {
  return middle + a[k] * b[0];
}

LANES_INLINE Lanes series_rest(int k, const Lanes *a, const Lanes *b) {
  return series_rest_around(series_middle(k, a, b), k, a, b);
}

/* Returns (a a)_k. */
LANES_INLINE Lanes series_square_around(Lanes middle, int k, const Lanes *a) {
  return middle + 2.0 * (a[0] * a[k]);
}

/* Each pair of different coefficients occurs twice in the sum. */
LANES_INLINE Lanes series_square(int k, const Lanes *a) {
  Lanes half = series_dot((k - 1) / 2, a + 1, a + k - 1) + a[0] * a[k];
  return k % 2 == 0 ? 2.0 * half + a[k / 2] * a[k / 2] : 2.0 * half;
}

/* (a / b)_k: top is a_k, possibly a constant, inverse is 1 / b_0, and c holds the quotient below k. */
LANES_INLINE Lanes lane_series_quotient(Lanes middle, int k, Lanes top, Lanes inverse, const Lanes *b, const Lanes *c) {
  return (top - (middle + b[k] * c[0])) * inverse;
}
#define series_quotient_around(middle, k, top, inverse, b, c)                                                          \
  lane_series_quotient(middle, k, LANES_OF(top), LANES_OF(inverse), b, c)
#define series_quotient(k, top, inverse, b, c) series_quotient_around(series_middle(k, b, c), k, top, inverse, b, c)

/* Returns (sqrt a)_k; 0 if a vanishes at all times. */
LANES_INLINE Lanes series_root_around(Lanes middle, int k, const Lanes *a, const Lanes *c) {
  Lanes root = (a[k] - middle) / (2.0 * c[0]);
  return lanes_select((c[0] == 0.0) & (c[k - 1] == 0.0) & (a[k] == 0.0), (Lanes){0}, root);
}

LANES_INLINE Lanes series_root(int k, const Lanes *a, const Lanes *c) {
  return series_root_around(series_middle(k, c, c), k, a, c);
}

/* Returns c_k for c' = a' b; rate is the series of a'. */
LANES_INLINE Lanes series_integral_around(Lanes middle, int k, const Lanes *rate, const Lanes *b) {
  return (middle + rate[k - 1] * b[0]) * reciprocal[k];
}

LANES_INLINE Lanes series_integral(int k, const Lanes *rate, const Lanes *b) {
  return series_integral_around(series_dot(k - 1, rate, b + k - 1), k, rate, b);
}

/* Returns c_k for c' = a' / b; top is a_k, possibly a constant. */
LANES_INLINE Lanes lane_series_ratio_integral(int k, Lanes top, const Lanes *b, const Lanes *c) {
  Lanes sum = {0};
  for (int j = 1; j < k; j++) sum += (double)j * c[j] * b[k - j];
  return (top - sum * reciprocal[k]) / b[0];
}
#define series_ratio_integral(k, top, b, c) lane_series_ratio_integral(k, LANES_OF(top), b, c)

/* Returns the sign of a(t) just after t = 0, from its first nonzero coefficient up to k: -1, 0 or 1. */
LANES_INLINE Lanes series_sign(int k, const Lanes *a) {
  Lanes first = {0};
  for (int j = k; j >= 0; j--) first = lanes_select(a[j] != 0.0, a[j], first);
  return WHERE(first > 0.0, 1.0, WHERE(first < 0.0, -1.0, 0.0));
}

/* Returns |a|_k just after t = 0. */
LANES_INLINE Lanes series_absolute(int k, const Lanes *a) {
  return series_sign(k, a) * a[k];
}

/* Returns the coefficient k - 1 of y' x - x' y, divided by k. */
LANES_INLINE Lanes series_area(int k, const Lanes *y, const Lanes *x) {
  Lanes sum = {0};
  for (int j = 1; j <= k; j++) sum += (double)j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return sum * reciprocal[k];
}

/* Returns the coefficient k of atan2(y, x); b is the series of x^2 + y^2. */
LANES_INLINE Lanes series_angle(int k, const Lanes *y, const Lanes *x, const Lanes *b, const Lanes *c) {
  return series_ratio_integral(k, series_area(k, y, x), b, c);
}

/* Returns (a^n)_k for any number n, lane by lane. */
Lanes lane_series_power(int k, Lanes n, const Lanes *a, const Lanes *c);
#define series_power(k, n, a, c) lane_series_power(k, LANES_OF(n), a, c)

#endif
