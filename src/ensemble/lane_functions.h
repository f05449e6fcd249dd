/* Elementary functions for lanes. */
#pragma once

#include "bounded_functions.h"
#include "lanes.h"
#include "random_numbers.h"

/* The names that generated code uses. */
#define lanes_fabs lanes_absolute
#define lanes_fmin lanes_smaller
#define lanes_fmax lanes_larger

/* Applies the function of C to each lane. */
#define LANE_FUNCTION(name)                                                                                            \
  LANES_INLINE Lanes lanes_##name(Lanes x) {                                                                           \
    for (int i = 0; i < LANES; i++) x[i] = name(x[i]);                                                                 \
    return x;                                                                                                          \
  }
#define LANE_FUNCTION_OF_TWO(name)                                                                                     \
  LANES_INLINE Lanes lanes_##name(Lanes x, Lanes y) {                                                                  \
    for (int i = 0; i < LANES; i++) x[i] = name(x[i], y[i]);                                                           \
    return x;                                                                                                          \
  }

LANE_FUNCTION(sqrt)
LANE_FUNCTION(tan)
LANE_FUNCTION(asin)
LANE_FUNCTION(acos)
LANE_FUNCTION(atan)
LANE_FUNCTION(sinh)
LANE_FUNCTION(cosh)
LANE_FUNCTION(tanh)
LANE_FUNCTION(asinh)
LANE_FUNCTION(acosh)
LANE_FUNCTION(atanh)
LANE_FUNCTION(exp)
LANE_FUNCTION(log)
LANE_FUNCTION(floor)
LANE_FUNCTION(logistic)
LANE_FUNCTION(softplus)
LANE_FUNCTION(sech)
LANE_FUNCTION(log_cosh)
LANE_FUNCTION(capped_exp)
LANE_FUNCTION(capped_exp_slope)
LANE_FUNCTION_OF_TWO(pow)
LANE_FUNCTION_OF_TWO(atan2)
LANE_FUNCTION_OF_TWO(random_uniform)
LANE_FUNCTION_OF_TWO(random_gauss)
#undef LANE_FUNCTION
#undef LANE_FUNCTION_OF_TWO

/*
 * The angle x minus the nearest multiple of pi/2, and that multiple modulo 4; for |x| <= LARGEST_ANGLE. Argument
 * reduction by W. J. Cody and W. Waite (Software Manual for the Elementary Functions, 1980): pi/2 is split into parts.
 * The products of all but the last with the multiple are exact, so that cancellation does not amplify rounding errors.
 */
struct QuarterTurns {
  Lanes rest;
  Mask turns;
};

/* Up to here, the multiple of pi/2 has 16 bits, and its products with the 33-bit parts are exact. */
#define LARGEST_ANGLE 1e5

LANES_INLINE struct QuarterTurns quarter_turns(Lanes x) {
  /* adding and subtracting it rounds to a whole number, whose low bits are those of the sum */
  const double rounder = 0x1.8p52;
  /* pi/2 in three parts, the first two of 33 bits */
  const double first = 0x1.921fb544p+0, second = 0x1.0b4611a6p-34, third = 0x1.3198a2e037073p-69;
  Lanes sum = x * 0x1.45f306dc9c883p-1 + rounder, count = sum - rounder;
  Lanes rest = x - count * first;
  Lanes part = count * second, nearer = rest - part;
  /* the rounding error of the subtraction, which matters if it cancels */
  Lanes lost = (rest - nearer) - part;
  return (struct QuarterTurns){.rest = nearer + (lost - count * third), .turns = (Mask)sum & 3};
}

/*
 * Taylor polynomials of sin and cos; for |x| <= pi/4 the first omitted term is below a hundredth of the rounding
 * error.
 */
LANES_INLINE Lanes sine_near_zero(Lanes x) {
  Lanes z = x * x;
  Lanes sum = z * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0));
  sum = z * (-1.0 / 39916800.0 + z * (1.0 / 6227020800.0 + sum));
  sum = z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + sum));
  return x + x * (z * (-1.0 / 6.0 + z * (1.0 / 120.0 + sum)));
}

LANES_INLINE Lanes cosine_near_zero(Lanes x) {
  Lanes z = x * x;
  Lanes sum = z * (1.0 / 20922789888000.0 - z * (1.0 / 6402373705728000.0));
  sum = z * (1.0 / 479001600.0 - z * (1.0 / 87178291200.0 - sum));
  sum = z * (1.0 / 40320.0 - z * (1.0 / 3628800.0 - sum));
  return 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - sum)));
}

/* Returns sin(x + more_turns pi/2); 1 gives cos. */
LANES_INLINE Lanes sine_after(Lanes x, int64_t more_turns) {
  struct QuarterTurns angle = quarter_turns(x);
  Mask turns = angle.turns + more_turns;
  Lanes sine = sine_near_zero(angle.rest), cosine = cosine_near_zero(angle.rest);
  Lanes value = lanes_select((turns & 1) == 0, sine, cosine);
  return (Lanes)((Bits)value ^ (Bits)(turns & 2) << 62);
}

/* Uses the functions of C for larger angles. */
#define LANE_SINE(name, more_turns)                                                                                    \
  LANES_INLINE Lanes lanes_##name(Lanes x) {                                                                           \
    Lanes value = sine_after(x, more_turns);                                                                           \
    Mask is_far = ~(lanes_absolute(x) <= LARGEST_ANGLE);                                                               \
    if (any_lane(is_far))                                                                                              \
      for (int i = 0; i < LANES; i++)                                                                                  \
        if (is_far[i]) value[i] = name(x[i]);                                                                          \
    return value;                                                                                                      \
  }
LANE_SINE(sin, 0)
LANE_SINE(cos, 1)
#undef LANE_SINE
