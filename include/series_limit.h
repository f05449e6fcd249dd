/*
 * How far Taylor series may be trusted, as their coefficients alone cannot tell: exp, tanh or a power may be flat where
 * a step starts, so that all coefficients vanish, and rise to a wall inside of it.
 *
 * A function f takes the polynomial u(t). On the disc |t| <= step of the complex plane, u stays within
 * sum over k >= 1 of |u_k| step^k, its excursion, of u_0. The step is shortened until f changes by no more than a factor
 * of e^5 in that disc and has no singular point there, or is constant there to the last bit. So a hill, a wall or a pole
 * of any width is approached, not passed over.
 */
#ifndef SERIES_LIMIT_H
#define SERIES_LIMIT_H

#include <math.h>
#include <stdbool.h>

#include "arithmetic.h"

struct SeriesLimit {
  int order;            /* of the polynomials */
  double step;          /* what the functions below shorten */
  const char *function; /* the one that shortened it last; NULL for none */
  bool crosses;         /* roots, powers, kinks and jumps, which stay finite, do not shorten it */
  bool surrounds;       /* what lies before the point counts as well; powers shorten it then too */
};

/* A call of one of the functions below, where the condition holds. */
#define LIMIT_WHERE(condition, ...)                                                                                    \
  do {                                                                                                                 \
    if (condition) __VA_ARGS__;                                                                                        \
  } while (0)

/* exp(u), also as the power of a constant */
void series_limit_exponential(struct SeriesLimit *limit, const double *u, const char *function);

/* sinh(u), cosh(u) */
void series_limit_hyperbolic(struct SeriesLimit *limit, const double *u, const char *function);

void series_limit_tanh(struct SeriesLimit *limit, const double *u);
void series_limit_tangent(struct SeriesLimit *limit, const double *u);

/* u must keep its sign: logarithms, and what the derivatives of inverse functions are divided by */
void series_limit_positive(struct SeriesLimit *limit, const double *u, const char *function);

/*
 * u^n; share of u_0 is what changes the power by e^5: 1 - e^(-5/|n|) for a negative n, e^(5/n) - 1 for a positive one.
 * Roots are all powers with n > 0 that are not whole. Whole powers up to HIGHEST_WIDE_POWER hide nothing: their hills are about
 * as wide as those of u, which the series of u knows.
 */
enum { HIGHEST_WIDE_POWER = 4 };
void series_limit_quotient(struct SeriesLimit *limit, const double *u, double share);
void series_limit_root(struct SeriesLimit *limit, const double *u, double share);
void series_limit_whole_power(struct SeriesLimit *limit, const double *u, double share);

/* numerator / u^n, where the numerator may vanish at all times */
void series_limit_division(struct SeriesLimit *limit, const double *u, const double *numerator, double share);

/* u^n for an exponent that is known at run time alone. */
void series_limit_power(struct SeriesLimit *limit, const double *u, double exponent);

/* The share for an exponent. */
static inline double series_limit_share(double exponent) {
  return exponent < 0.0 ? 1.0 - exp(5.0 / exponent) : exp(5.0 / exponent) - 1.0;
}

/* u must keep its sign, on the real axis alone: each piece of abs, sign, min and max is a series of its own. */
void series_limit_sign(struct SeriesLimit *limit, const double *u, const char *function);

/* atan2(y, x) jumps where y = 0 and x < 0. */
void series_limit_angle(struct SeriesLimit *limit, const double *y, const double *x);

#endif
