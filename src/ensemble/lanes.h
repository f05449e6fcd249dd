/*
 * Vectors with a number for each of LANES runs, as wide as the processor's vectors. Operations on a lane never
 * depend on other lanes or on LANES. So a run has the same results in any ensemble and on any processor.
 */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define LANES_INLINE static inline __attribute__((always_inline, unused))

typedef double Lanes __attribute__((vector_size(LANES * sizeof(double))));

/* The result of a comparison: all bits of a lane are 1 or 0. Bits: the bits of a number. */
typedef int64_t Mask __attribute__((vector_size(LANES * sizeof(int64_t))));
typedef uint64_t Bits __attribute__((vector_size(LANES * sizeof(uint64_t))));

/* A number in all lanes; vectors are unchanged. */
#define LANES_OF(number) ((number) - (Lanes){0})

/* A number in all lanes, for a static initializer. */
#if LANES == 8
#define LANES_CONSTANT(number)                                                                                         \
  { number, number, number, number, number, number, number, number }
#elif LANES == 4
#define LANES_CONSTANT(number)                                                                                         \
  { number, number, number, number }
#else
#define LANES_CONSTANT(number)                                                                                         \
  { number, number }
#endif

/* Returns `first` in the lanes of the mask, and `second` in the others. */
LANES_INLINE Lanes lanes_select(Mask mask, Lanes first, Lanes second) {
  return (Lanes)(((Mask)first & mask) | ((Mask)second & ~mask));
}

/* True if the mask holds in any lane. */
LANES_INLINE bool any_lane(Mask mask) {
  int64_t found = 0;
  for (int i = 0; i < LANES; i++) found |= mask[i];
  return found != 0;
}

/* Returns the absolute values. */
LANES_INLINE Lanes lanes_absolute(Lanes a) {
  return (Lanes)((Mask)a & INT64_MAX);
}

/* Return the second operand if either is NaN, which callers exclude. */
LANES_INLINE Lanes lanes_larger(Lanes a, Lanes b) {
  return lanes_select(a > b, a, b);
}

LANES_INLINE Lanes lanes_smaller(Lanes a, Lanes b) {
  return lanes_select(a < b, a, b);
}

/* Returns the lanes in which the number is neither infinite nor NaN. */
LANES_INLINE Mask lanes_are_finite(Lanes a) {
  return lanes_absolute(a) < INFINITY;
}
