/* Chebyshev polynomials of degree 8 through what is sampled in a window of time. */
#ifndef CHEBYSHEV_H
#define CHEBYSHEV_H

#include "real.h"

enum { CHEBYSHEV_DEGREE = 8, CHEBYSHEV_NODES };

/* The time of a node, from 0, the end of the window, to 8, its beginning; node 4 is the middle. */
Real chebyshev_time(Real from, Real to, int node);

/* Those of all. */
void chebyshev_times(Real from, Real to, Real *times);

/* The coefficients c[CHEBYSHEV_NODES] of the polynomial through f[CHEBYSHEV_NODES] at the nodes. */
void chebyshev_coefficients(const Real *f, Real *c);

/* How far the polynomial may go from its first coefficient. */
Real chebyshev_range(const Real *c);

/* The last coefficients, and what they may have of the range for a polynomial that is the function. */
Real chebyshev_tail(const Real *c);
static const double chebyshev_resolved = 1e-4;

/* The coefficients of its derivative, by a place from -1 to 1, and what the tail may make of it, and of its own derivative. */
void chebyshev_derivative(const Real *c, Real *d);
static const double chebyshev_tail_of_derivative = 4.0 * CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE;
static const double chebyshev_tail_of_curvature =
    4.0 * CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE * (CHEBYSHEV_DEGREE * CHEBYSHEV_DEGREE - 1) / 3.0;

/* The value at a place from -1, the beginning of the window, to 1. */
Real chebyshev_value(const Real *c, Real place);

/* Its coefficients of powers of the time from the middle on, in a window of twice the half length. */
void chebyshev_powers(const Real *c, Real half, Real *power);

#endif
