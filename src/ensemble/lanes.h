/*
 * Numbers of several runs side by side, a lane for each: vectors of the compiler, as wide as the processor's. LANES is how
 * many there are. What is done to one lane never depends on another or on how many there are, so that a run has the same
 * results among any others and on any processor.
 */
#ifndef LANES_H
#define LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define LANES_INLINE static inline __attribute__((always_inline, unused))

typedef double Lanes __attribute__((vector_size(LANES * sizeof(double))));

/* Of each lane all bits or none, as comparisons give it; and the bits of a number. */
typedef int64_t Mask __attribute__((vector_size(LANES * sizeof(int64_t))));
typedef uint64_t Bits __attribute__((vector_size(LANES * sizeof(uint64_t))));

/* The same number in all lanes; lanes stay what they are. */
#define LANES_OF(number) ((number) - (Lanes){0})

/* Likewise, in the initializer of an array that is static. */
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

LANES_INLINE Lanes lanes_select(Mask mask, Lanes first, Lanes second) {
  return (Lanes)(((Mask)first & mask) | ((Mask)second & ~mask));
}

LANES_INLINE bool any_lane(Mask mask) {
  int64_t found = 0;
  for (int i = 0; i < LANES; i++) found |= mask[i];
  return found != 0;
}

LANES_INLINE Lanes lanes_absolute(Lanes a) {
  return (Lanes)((Mask)a & INT64_MAX);
}

/* Of a NaN and a number the second; both are never NaN in what is compared here. */
LANES_INLINE Lanes lanes_larger(Lanes a, Lanes b) {
  return lanes_select(a > b, a, b);
}

LANES_INLINE Lanes lanes_smaller(Lanes a, Lanes b) {
  return lanes_select(a < b, a, b);
}

LANES_INLINE Mask lanes_are_finite(Lanes a) {
  return lanes_absolute(a) < INFINITY;
}

#endif
