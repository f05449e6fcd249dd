/*
 * Recurrences for Taylor coefficients, which the code that lagc generates calls (A. Jorba, M. Zou: A software package
 * for the numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14, 2005,
 * section 2).
 *
 * a[j], b[j], ... are the coefficients of t^j. Each function returns coefficient k >= 1 of its result, from those of
 * its operands up to k and those of the result below k. With w = a b it is w_k = sum over j = 0 .. k of a_j b_(k-j);
 * functions that satisfy a differential equation, such as exp and sin, have recurrences of the same shape. An order k
 * costs O(k) operations a function, a series up to order p O(p^2).
 *
 * Each sum is split into a middle part, which needs only coefficients below k, and the terms with coefficient k. The
 * middle parts of an order do not depend on each other, so the processor can overlap them.
 */
#ifndef SERIES_H
#define SERIES_H

#include <math.h>
#include <stddef.h>

#include "real.h"

/* Keeps one copy of each function that contains the branches over all orders. */
#ifdef __GNUC__
#define SERIES_INLINE inline __attribute__((always_inline))
#define SERIES_NOT_INLINE __attribute__((noinline, unused))
#else
#define SERIES_INLINE inline
#define SERIES_NOT_INLINE inline
#endif

#ifdef __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define SERIES_HAS_VECTORS
#endif
#endif

/* Two adjacent products. Compilers with vector extensions compute them by one instruction. */
#ifdef SERIES_HAS_VECTORS
typedef double Pair __attribute__((vector_size(2 * sizeof(double))));

static SERIES_INLINE Pair pair_product(const double *a, const double *b) {
  Pair forwards, backwards;
  __builtin_memcpy(&forwards, a, sizeof forwards);
  __builtin_memcpy(&backwards, b - 1, sizeof backwards);
  return forwards * __builtin_shufflevector(backwards, backwards, 1, 0);
}

static SERIES_INLINE Pair pair_sum(Pair a, Pair b) {
  return a + b;
}

static SERIES_INLINE double pair_total(Pair a) {
  return a[0] + a[1];
}

static SERIES_INLINE Pair pair_at(const double *a) {
  Pair pair;
  __builtin_memcpy(&pair, a, sizeof pair);
  return pair;
}

static SERIES_INLINE Pair pair_multiple(Pair a, double factor) {
  return a * factor;
}

static SERIES_INLINE double pair_first(Pair a) {
  return a[0];
}

static SERIES_INLINE double pair_second(Pair a) {
  return a[1];
}
#else
#include "pairs.h"
#endif

/*
 * Computes the middle terms of all products at order k >= 1: m[i] = sum over j = 0 .. k - 2 of
 * a[from + j] b[k - 1 - j]. PRODUCTS(EACH) is a list of EACH(i, a, from, b). Adds pairs of adjacent terms; the first
 * and the last term, which use the newest coefficients, come last. Rows that are factors of several products are read
 * once.
 */
#define SERIES_MIDDLES(PRODUCTS)                                                                                       \
  do {                                                                                                                 \
    if (k < 3) {                                                                                                       \
      PRODUCTS(SERIES_MIDDLE_OF_LOW_ORDER)                                                                             \
      break;                                                                                                           \
    }                                                                                                                  \
    PRODUCTS(SERIES_NO_PAIRS)                                                                                          \
    for (int j = 1; j + 3 < k; j += 2) {                                                                               \
      PRODUCTS(SERIES_NEXT_PAIR)                                                                                       \
    }                                                                                                                  \
    PRODUCTS(SERIES_MIDDLE_OF_PAIRS)                                                                                   \
    if (k % 2 == 0) {                                                                                                  \
      PRODUCTS(SERIES_TERM_WITHOUT_NEIGHBOUR)                                                                          \
    }                                                                                                                  \
  } while (0)
#define SERIES_MIDDLE_OF_LOW_ORDER(i, a, from, b) m[i] = k == 2 ? (a)[from] * (b)[1] : 0.0;
#define SERIES_NO_PAIRS(i, a, from, b) Pair pairs##i = {0.0, 0.0};
#define SERIES_NEXT_PAIR(i, a, from, b) pairs##i = pair_sum(pairs##i, pair_product((a) + (from) + j, (b) + k - 1 - j));
#define SERIES_MIDDLE_OF_PAIRS(i, a, from, b)                                                                          \
  m[i] = pair_total(pairs##i) + ((a)[from] * (b)[k - 1] + (a)[(from) + k - 2] * (b)[1]);
#define SERIES_TERM_WITHOUT_NEIGHBOUR(i, a, from, b) m[i] += (a)[(from) + k - 3] * (b)[2];

/* Returns the middle terms of one product. */
#define SERIES_ONE(EACH) EACH(0, a, 0, b)
static SERIES_NOT_INLINE double series_middle(int k, const double *a, const double *b) {
  double m[1];
  SERIES_MIDDLES(SERIES_ONE);
  return m[0];
}

/* Computes the middle terms of a list of products, four at a time, for systems too large for unrolled code. */
struct SeriesFactors {
  const double *a, *b;
};
#define SERIES_FACTORS(a, from, b) {(a) + (from), (b)},
#define SERIES_NEXT_FOUR(EACH)                                                                                         \
  EACH(0, next[0].a, 0, next[0].b)                                                                                     \
  EACH(1, next[1].a, 0, next[1].b) EACH(2, next[2].a, 0, next[2].b) EACH(3, next[3].a, 0, next[3].b)

static SERIES_NOT_INLINE void series_middles(int k, size_t count, const struct SeriesFactors *next, double *m) {
  for (; count >= 4; count -= 4, next += 4, m += 4) SERIES_MIDDLES(SERIES_NEXT_FOUR);
  for (; count > 0; count--, next++, m++) *m = series_middle(k, next->a, next->b);
}

/*
 * Returns (a^n)_k for a real n; c holds the power's coefficients below k. If a_m is the first nonzero coefficient and
 * m > 0, then a = t^m b and a^n = t^(m n) b^n, with b_j = a_(m+j) and (b^n)_j = c_(m n+j). Then n must be a whole
 * number >= 0, else the result is NAN.
 */
static inline double series_power(int k, double n, const double *a, const double *c) {
  int m = 0;
  while (m <= k && a[m] == 0.0) m++;
  if (m > k && n > 0.0) return 0.0;
  if (m > 0 && !(n >= 0.0 && n == floor(n))) return NAN;
  if (m > k || m * n > k) return 0.0;
  int first = m * (int)n, last = k - first;
  if (last == 0) return pow(a[m], n);
  double sum = 0.0;
  for (int j = 0; j < last; j++) sum += (n * (last - j) - j) * a[m + last - j] * c[first + j];
  return sum / (last * a[m]);
}

/* Returns c_k of c' = a' / b; top is a_k. */
static inline double series_ratio_integral(int k, double top, const double *b, const double *c) {
  double sum = 0.0;
  for (int j = 1; j < k; j++) sum += j * c[j] * b[k - j];
  return (top - sum / k) / b[0];
}

/* Returns the sign of a(t) just after t = 0, -1, 0 or 1, as determined by the coefficients up to k. */
static inline double series_sign(int k, const double *a) {
  int j = 0;
  while (j < k && a[j] == 0.0) j++;
  return (double)((a[j] > 0.0) - (a[j] < 0.0));
}

/* Returns coefficient k - 1 of y' x - x' y, divided by k. */
static inline double series_area(int k, const double *y, const double *x) {
  double sum = 0.0;
  for (int j = 1; j <= k; j++) sum += j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return sum / k;
}

#include "series_terms.h"

static SERIES_INLINE double series_square(int k, const double *a) {
  return series_square_around(series_middle(k, a + 1, a), k, a);
}

#endif
