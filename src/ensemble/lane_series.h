/* The recurrences of include/series.h for lanes, under the same names and include guard, so that it replaces them. */
#ifndef SERIES_H
#define SERIES_H

#include "lane_real.h"
#include "reciprocals.h"

#define SERIES_INLINE inline __attribute__((always_inline, unused))
#include "pairs.h"

/* Returns the sum of a[j] b[-j] for j < n; the additions form one chain, beside which other sums run. */
LANES_INLINE Lanes series_dot(int n, const Lanes *a, const Lanes *b) {
  Lanes sum = {0};
  for (int j = 0; j < n; j++) sum += a[j] * b[-j];
  return sum;
}

LANES_INLINE Lanes series_middle(int k, const Lanes *a, const Lanes *b) {
  return series_dot(k - 1, a, b + k - 1);
}

/* Computes the middle terms m[i] of all products of an order. */
#define SERIES_MIDDLES(PRODUCTS) PRODUCTS(SERIES_MIDDLE)
#define SERIES_MIDDLE(i, a, from, b) m[i] = series_middle(k, (a) + (from), b);

struct SeriesFactors {
  const Lanes *a, *b;
};
#define SERIES_FACTORS(a, from, b) {(a) + (from), (b)},

LANES_INLINE void series_middles(int k, size_t count, const struct SeriesFactors *factors, Lanes *m) {
  for (size_t i = 0; i < count; i++) m[i] = series_middle(k, factors[i].a, factors[i].b);
}

/* Each pair of different coefficients occurs twice in the sum. */
LANES_INLINE Lanes series_square(int k, const Lanes *a) {
  Lanes half = series_dot((k - 1) / 2, a + 1, a + k - 1) + a[0] * a[k];
  return k % 2 == 0 ? 2.0 * half + a[k / 2] * a[k / 2] : 2.0 * half;
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

/* Returns the coefficient k - 1 of y' x - x' y, divided by k. */
LANES_INLINE Lanes series_area(int k, const Lanes *y, const Lanes *x) {
  Lanes sum = {0};
  for (int j = 1; j <= k; j++) sum += (double)j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return sum * reciprocal[k];
}

/* Returns (a^n)_k for any number n, lane by lane. */
Lanes lane_series_power(int k, Lanes n, const Lanes *a, const Lanes *c);
#define series_power(k, n, a, c) lane_series_power(k, LANES_OF(n), a, c)

#include "series_terms.h"

/* The dividend and the inverse may be constants. */
#define series_quotient_around(middle, k, top, inverse, b, c)                                                          \
  (series_quotient_around)(middle, k, LANES_OF(top), LANES_OF(inverse), b, c)
#define series_quotient(k, top, inverse, b, c) (series_quotient)(k, LANES_OF(top), LANES_OF(inverse), b, c)

#endif
