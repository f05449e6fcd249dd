/*
 * Interpolation by Chebyshev polynomials of degree 8 in an interval of time (L. N. Trefethen: Approximation Theory and
 * Approximation Practice, 2013). s in [-1, 1] is the time in the interval; T_k(s) is at most 1 in size, so coefficients
 * bound the polynomial.
 */
#pragma once

#include "real.h"

/* Degree of the polynomials, and number of their nodes. */
enum { CHEBYSHEV_DEGREE = 8, CHEBYSHEV_NODES };

/* Returns the time of a node: node 0 is the end of the interval, 8 its start, 4 its middle. */
Real chebyshev_time(Real from, Real to, int node);

/* Computes the times of all nodes. */
void chebyshev_times(Real from, Real to, Real *times);

/* Computes the coefficients c[CHEBYSHEV_NODES] of the polynomial with values f[CHEBYSHEV_NODES] at the nodes. */
void chebyshev_coefficients(const Real *f, Real *c);

/* Returns a bound of |p(s) - c[0]|: the sum of the other |c[k]|. */
Real chebyshev_range(const Real *c);

/*
 * Returns |c[7]| + |c[8]|, which estimates the interpolation error. A polynomial is resolved if this is at most
 * chebyshev_resolved times chebyshev_range().
 */
Real chebyshev_tail(const Real *c);
static const double chebyshev_resolved = 1e-4;

/*
 * Computes the coefficients d of dp/ds. The tail of c times chebyshev_tail_of_derivative bounds its effect on the first
 * derivative, and times chebyshev_tail_of_curvature that on the second: four times Markov's inequalities.
 */
void chebyshev_derivative(const Real *c, Real *d);
static const double chebyshev_tail_of_derivative = 4.0 * CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE;
static const double chebyshev_tail_of_curvature =
    4.0 * CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE * (CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE - 1) / 3.0;

/* Returns p(s). */
Real chebyshev_value(const Real *c, Real slot);

/* Computes the coefficients by powers of the time from the middle of an interval of length 2 half. */
void chebyshev_powers(const Real *c, Real half, Real *power);
