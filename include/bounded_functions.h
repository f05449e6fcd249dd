/*
 * Functions that are finite for every number u, while parts of their formulas overflow, such as exp(u) in 1/(1 +
 * exp(u)).
 */
#ifndef BOUNDED_FUNCTIONS_H
#define BOUNDED_FUNCTIONS_H

#include <math.h>

/* Returns 1/(1 + exp(-u)) to a few rounding errors; far below 0 it is 1/inf = 0. */
static inline double logistic(double u) {
  return 1.0 / (1.0 + exp(-u));
}

/* Returns log(1 + exp(u)). */
static inline double softplus(double u) {
  return fmax(u, 0.0) + log1p(exp(-fabs(u)));
}

/* Returns 1/cosh(u). */
static inline double sech(double u) {
  return 1.0 / cosh(u);
}

/* Returns log(cosh(u)); near 0 by cosh(u) - 1 = 2 sinh(u/2)^2, without cancellation. */
static inline double log_cosh(double u) {
  double half = sinh(0.5 * u);
  return fabs(u) < 20.0 ? log1p(2.0 * half * half) : fabs(u) - 0.693147180559945309417;
}

/*
 * Returns exp(min(u, EXPONENT_CAP)). It serves as the argument of a function that is constant to rounding for large
 * arguments, such as exp(-exp(u)). exp(200) = 7e86 is large enough even with a factor of 1e-80.
 */
#define EXPONENT_CAP 200.0
static inline double capped_exp(double u) {
  return exp(fmin(u, EXPONENT_CAP));
}

/* Returns the derivative of capped_exp(). */
static inline double capped_exp_slope(double u) {
  return u < EXPONENT_CAP ? exp(u) : 0.0;
}

#endif
