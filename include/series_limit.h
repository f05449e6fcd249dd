/*
 * Bounds the step of a Taylor method by the arguments of elementary functions. The coefficients of a solution alone
 * cannot bound it. exp, tanh or a power may be flat at the start of a step, where all coefficients vanish, and rise
 * steeply within it.
 *
 * A function f takes the polynomial u(t). On the disc |t| <= h of the complex plane, |u(t) - u_0| is at most the
 * excursion
 *
 *  e(h) = sum over k >= 1 of |u_k| h^k.
 *
 * Each bound is a condition e(h) <= c. Then f is constant to the last bit, or it changes by a factor of at most e^5
 * in the disc and has no singularity there. By Cauchy's estimate (L. V. Ahlfors: Complex Analysis, chapter 4) the
 * coefficients of f then decay like those of a geometric series. So no peak, step or pole of any width is skipped.
 * For whole powers a monotone u also suffices, for signs one that moves away from 0.
 *
 * e(h) increases with h. The step is divided by 8 until the condition holds, then refined by four bisections of its
 * logarithm, to a factor of 8^(1/16). Each trial costs O(order).
 */
#ifndef SERIES_LIMIT_H
#define SERIES_LIMIT_H

#include <math.h>
#include <stdbool.h>

#include "arithmetic.h"

/* A bound on the step that the functions below reduce, and never increase. */
struct SeriesLimit {
  int order;            /* of the polynomials */
  double step;          /* the bound, in s; the functions below reduce it */
  const char *function; /* name of the function that reduced it last; NULL for none */
  bool crosses;         /* roots, powers, kinks and jumps do not reduce it, as they stay finite */
  bool surrounds;       /* the bound must hold before the point too; then powers reduce it in any case */
};

/* Calls one of the functions below if the condition holds. */
#define LIMIT_WHERE(condition, ...)                                                                                    \
  do {                                                                                                                 \
    if (condition) __VA_ARGS__;                                                                                        \
  } while (0)

/* Reduces the step by exp(u), or a power of a constant. */
void series_limit_exponential(struct SeriesLimit *limit, const double *u, const char *function);

/* Reduces it by sinh(u) or cosh(u). */
void series_limit_hyperbolic(struct SeriesLimit *limit, const double *u, const char *function);

/* Reduces it by 1/(1 + exp(u)), 1/cosh(u) or their logarithms, whose tails may be factors of large numbers. */
void series_limit_bounded(struct SeriesLimit *limit, const double *u, const char *function);

void series_limit_tanh(struct SeriesLimit *limit, const double *u);
void series_limit_tangent(struct SeriesLimit *limit, const double *u);

/* Reduces it so that u keeps its sign: logarithms, and denominators in derivatives of inverse functions. */
void series_limit_positive(struct SeriesLimit *limit, const double *u, const char *function);

/*
 * Reduce it by u^n. share is the relative change of u_0 that changes the power by e^5: 1 - e^(-5/|n|) for n < 0,
 * e^(5/n) - 1 for n > 0. series_limit_root() takes the powers n > 0 that are not whole. Whole powers up to
 * HIGHEST_WIDE_POWER need no bound: their peaks are about as wide as those of u itself, which the series of u resolves.
 */
enum { HIGHEST_WIDE_POWER = 4 };
void series_limit_quotient(struct SeriesLimit *limit, const double *u, double share);
void series_limit_root(struct SeriesLimit *limit, const double *u, double share);
void series_limit_whole_power(struct SeriesLimit *limit, const double *u, double share);

/* Reduces it by numerator / u^n. An identically vanishing numerator imposes no bound. */
void series_limit_division(struct SeriesLimit *limit, const double *u, const double *numerator, double share);

/* Reduces it by u^n with an exponent known only at run time. */
void series_limit_power(struct SeriesLimit *limit, const double *u, double exponent);

/* Returns the share of an exponent. */
static inline double series_limit_share(double exponent) {
  return exponent < 0.0 ? 1.0 - exp(5.0 / exponent) : exp(5.0 / exponent) - 1.0;
}

/* Reduces it so that u keeps its sign on the real axis: each piece of abs, sign, min and max has its own series. */
void series_limit_sign(struct SeriesLimit *limit, const double *u, const char *function);

/* Reduces it by atan2(y, x), which jumps at y = 0, x < 0. */
void series_limit_angle(struct SeriesLimit *limit, const double *y, const double *x);

#endif
