/* Functions of which formulas hold parts that overflow, such as exp(u) in 1/(1 + exp(u)), for every number u. */
#ifndef BOUNDED_FUNCTIONS_H
#define BOUNDED_FUNCTIONS_H

#include <math.h>

/* 1/(1 + exp(-u)), to some roundings of itself; 1/inf = 0 is its value far below 0. */
static inline double logistic(double u) {
  return 1.0 / (1.0 + exp(-u));
}

/* log(1 + exp(u)) */
static inline double softplus(double u) {
  return fmax(u, 0.0) + log1p(exp(-fabs(u)));
}

/* 1/cosh(u) */
static inline double sech(double u) {
  return 1.0 / cosh(u);
}

/* log(cosh(u)): near 0 by cosh(u) - 1 = 2 sinh(u/2)^2, without cancellation. */
static inline double log_cosh(double u) {
  double half = sinh(0.5 * u);
  return fabs(u) < 20.0 ? log1p(2.0 * half * half) : fabs(u) - 0.693147180559945309417;
}

#endif
