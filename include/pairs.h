/* Pairs of series.h without vectors of the processor: for other compilers, and over lanes. */
#pragma once

typedef struct Pair {
  Real first, second;
} Pair;

static SERIES_INLINE Pair pair_product(const Real *a, const Real *b) {
  return (Pair){a[0] * b[0], a[1] * b[-1]};
}

static SERIES_INLINE Pair pair_sum(Pair a, Pair b) {
  return (Pair){a.first + b.first, a.second + b.second};
}

static SERIES_INLINE Real pair_total(Pair a) {
  return a.first + a.second;
}

static SERIES_INLINE Pair pair_at(const Real *a) {
  return (Pair){a[0], a[1]};
}

static SERIES_INLINE Pair pair_multiple(Pair a, Real factor) {
  return (Pair){a.first * factor, a.second * factor};
}

static SERIES_INLINE Real pair_first(Pair a) {
  return a.first;
}

static SERIES_INLINE Real pair_second(Pair a) {
  return a.second;
}
