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
#include <stddef.h>

#include "real.h"

enum { SERIES_LENGTH = 24 };

typedef Real Series[SERIES_LENGTH];

/* Functions with the switch over all orders stand once. */
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

/* Two neighbouring products, which the processor computes as one where the compiler can say so. */
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
typedef struct Pair {
  double first, second;
} Pair;

static SERIES_INLINE Pair pair_product(const double *a, const double *b) {
  return (Pair){a[0] * b[0], a[1] * b[-1]};
}

static SERIES_INLINE Pair pair_sum(Pair a, Pair b) {
  return (Pair){a.first + b.first, a.second + b.second};
}

static SERIES_INLINE double pair_total(Pair a) {
  return a.first + a.second;
}

static SERIES_INLINE Pair pair_at(const double *a) {
  return (Pair){a[0], a[1]};
}

static SERIES_INLINE Pair pair_multiple(Pair a, double factor) {
  return (Pair){a.first * factor, a.second * factor};
}

static SERIES_INLINE double pair_first(Pair a) {
  return a.first;
}

static SERIES_INLINE double pair_second(Pair a) {
  return a.second;
}
#endif

/*
 * sum of a[j] b[-j] for j < n, b running backwards, by pairs of neighbours. The sum is a tree, so that few additions
 * wait for one another and rounding grows with the logarithm of n.
 */
static SERIES_INLINE Pair series_pairs1(const double *a, const double *b) {
  return pair_product(a, b);
}

#define SERIES_PAIRS(n, half, rest)                                                                                    \
  static SERIES_INLINE Pair series_pairs##n(const double *a, const double *b) {                                        \
    return pair_sum(series_pairs##half(a, b), series_pairs##rest(a + 2 * (half), b - 2 * (half)));                     \
  }
SERIES_PAIRS(2, 1, 1)
SERIES_PAIRS(3, 2, 1)
SERIES_PAIRS(4, 2, 2)
SERIES_PAIRS(5, 3, 2)
SERIES_PAIRS(6, 3, 3)
SERIES_PAIRS(7, 4, 3)
SERIES_PAIRS(8, 4, 4)
SERIES_PAIRS(9, 5, 4)
SERIES_PAIRS(10, 5, 5)
SERIES_PAIRS(11, 6, 5)
SERIES_PAIRS(12, 6, 6)
#undef SERIES_PAIRS

#define SERIES_DOT(even, odd, pairs)                                                                                   \
  static SERIES_INLINE double series_dot##even(const double *a, const double *b) {                                     \
    return pair_total(series_pairs##pairs(a, b));                                                                      \
  }                                                                                                                    \
  static SERIES_INLINE double series_dot##odd(const double *a, const double *b) {                                      \
    return pair_total(series_pairs##pairs(a, b)) + a[(even)] * b[-(even)];                                             \
  }
SERIES_DOT(2, 3, 1)
SERIES_DOT(4, 5, 2)
SERIES_DOT(6, 7, 3)
SERIES_DOT(8, 9, 4)
SERIES_DOT(10, 11, 5)
SERIES_DOT(12, 13, 6)
SERIES_DOT(14, 15, 7)
SERIES_DOT(16, 17, 8)
SERIES_DOT(18, 19, 9)
SERIES_DOT(20, 21, 10)
SERIES_DOT(22, 23, 11)
#undef SERIES_DOT

static SERIES_INLINE double series_dot1(const double *a, const double *b) {
  return a[0] * b[0];
}

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
  default: return 0.0;
  }
}

static SERIES_NOT_INLINE double series_dot(int n, const double *a, const double *b) {
  return series_dot_by_size(n, a, b);
}

static SERIES_INLINE double series_middle_by_size(int k, const double *a, const double *b) {
  if (k < 3) return k == 2 ? a[1] * b[1] : 0.0;
  return series_dot_by_size(k - 3, a + 2, b + k - 2) + (a[1] * b[k - 1] + a[k - 1] * b[1]);
}

/*
 * The sum of a_j b_(k-j) without the ends j = 0 and j = k. The newest coefficients stand alone: a pair that holds one
 * would wait until it has reached memory.
 */
static SERIES_NOT_INLINE double series_middle(int k, const double *a, const double *b) {
  return series_middle_by_size(k, a, b);
}

/*
 * The middle terms of all products of an order k, m[i] = sum of a[from + j] b[k - 1 - j] for j < k - 1, where PRODUCTS(EACH)
 * is a list of EACH(i, a, from, b): by pairs of neighbours, the newest coefficients alone. They are sums of coefficients
 * below k, and so none waits for another; rows that are factors of several products are read once.
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

/* The same for so many products that the code of each would leave the processor's caches: from a list, by fours. */
struct SeriesFactors {
  const double *a, *b;
};
#define SERIES_FACTORS(i, a, from, b) {(a) + (from), (b)},
#define SERIES_NEXT(EACH) EACH(0, next[0].a, 0, next[0].b)
#define SERIES_NEXT_FOUR(EACH)                                                                                         \
  SERIES_NEXT(EACH)                                                                                                    \
  EACH(1, next[1].a, 0, next[1].b) EACH(2, next[2].a, 0, next[2].b) EACH(3, next[3].a, 0, next[3].b)

static SERIES_NOT_INLINE void series_middles(int k, size_t count, const struct SeriesFactors *next, double *m) {
  for (; count >= 4; count -= 4, next += 4, m += 4) SERIES_MIDDLES(SERIES_NEXT_FOUR);
  for (; count > 0; count--, next++, m++) SERIES_MIDDLES(SERIES_NEXT);
}

/*
 * (a b)_k, where b is the row that is computed later: what is waited for comes last. Here and below, ..._around() has
 * the middle terms.
 */
static SERIES_INLINE double series_product_around(double middle, int k, const double *a, const double *b) {
  return (middle + a[k] * b[0]) + a[0] * b[k];
}

/* (a b)_k, of rows in any order. */
static SERIES_NOT_INLINE double series_product(int k, const double *a, const double *b) {
  return series_middle_by_size(k, a, b) + (a[0] * b[k] + a[k] * b[0]);
}

/* (a b)_k without its first term a_0 b_k */
static SERIES_INLINE double series_rest_around(double middle, int k, const double *a, const double *b) {
  return middle + a[k] * b[0];
}

static SERIES_INLINE double series_rest(int k, const double *a, const double *b) {
  return series_rest_around(series_middle(k, a, b), k, a, b);
}

/* (a a)_k */
static SERIES_INLINE double series_square_around(double middle, int k, const double *a) {
  return middle + 2.0 * (a[0] * a[k]);
}

/* Each pair of different coefficients stands twice in the sum. */
static SERIES_INLINE double series_square(int k, const double *a) {
  double half = a[0] * a[k];
  if (k > 2) half += series_dot((k - 3) / 2, a + 2, a + k - 2) + a[1] * a[k - 1];
  return k % 2 == 0 ? 2.0 * half + a[k / 2] * a[k / 2] : 2.0 * half;
}

/* (a / b)_k, where top is a_k, inverse is 1 / b_0 and c holds the quotient so far */
static SERIES_INLINE double series_quotient_around(double middle, int k, double top, double inverse, const double *b,
                                                   const double *c) {
  return (top - (middle + b[k] * c[0])) * inverse;
}

static SERIES_INLINE double series_quotient(int k, double top, double inverse, const double *b, const double *c) {
  return ((top - b[k] * c[0]) - series_middle(k, b, c)) * inverse;
}

/* (sqrt a)_k; the root of 0 at all times is 0 */
static SERIES_INLINE double series_root_around(double middle, int k, const double *a, const double *c) {
  if (c[0] == 0.0 && c[k - 1] == 0.0 && a[k] == 0.0) return 0.0;
  return (a[k] - middle) / (2.0 * c[0]);
}

static SERIES_INLINE double series_root(int k, const double *a, const double *c) {
  return series_root_around(series_dot(k - 1, c + 1, c + k - 1), k, a, c);
}

/*
 * (a^n)_k for any number n. Where a starts with its term m > 0, a = t^m b and a^n = t^(m n) b^n exist for whole n > 0;
 * b_j = a_(m+j), and (b^n)_j = c_(mn+j).
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

/* c' = a' b: c_k, with the series of a' */
static SERIES_INLINE double series_integral_around(double middle, int k, const double *rate, const double *b) {
  return (middle + rate[k - 1] * b[0]) * (1.0 / k);
}

static SERIES_INLINE double series_integral(int k, const double *rate, const double *b) {
  if (k < 3) return (k == 1 ? rate[0] * b[0] : rate[0] * b[1] + rate[1] * b[0]) * (1.0 / k);
  double old = series_dot(k - 3, rate + 1, b + k - 2) + (rate[0] * b[k - 1] + rate[k - 2] * b[1]);
  return (old + rate[k - 1] * b[0]) * (1.0 / k);
}

/* c' = a' / b: c_k, where top is a_k */
static inline double series_ratio_integral(int k, double top, const double *b, const double *c) {
  double sum = 0.0;
  for (int j = 1; j < k; j++) sum += j * c[j] * b[k - j];
  return (top - sum / k) / b[0];
}

/* The sign that a(t) has at first for t > 0, as far as its coefficients up to k tell: -1, 0 or 1 */
static inline double series_sign(int k, const double *a) {
  int j = 0;
  while (j < k && a[j] == 0.0) j++;
  return (double)((a[j] > 0.0) - (a[j] < 0.0));
}

/* |a|_k, of the piece that is there first */
static inline double series_absolute(int k, const double *a) {
  return series_sign(k, a) * a[k];
}

/* The coefficient k - 1 of y' x - x' y, divided by k */
static inline double series_area(int k, const double *y, const double *x) {
  double sum = 0.0;
  for (int j = 1; j <= k; j++) sum += j * (y[j] * x[k - j] - x[j] * y[k - j]);
  return sum / k;
}

/* The coefficient k of atan2(y, x), with the series of x^2 + y^2 in b */
static inline double series_angle(int k, const double *y, const double *x, const double *b, const double *c) {
  return series_ratio_integral(k, series_area(k, y, x), b, c);
}

#endif
