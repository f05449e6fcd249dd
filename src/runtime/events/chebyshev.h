/* Chebyshev polynomials of degree 8 through what is sampled in a window of time. */
#ifndef CHEBYSHEV_H
#define CHEBYSHEV_H

enum { CHEBYSHEV_DEGREE = 8, CHEBYSHEV_NODES };

/* The time of a node, from 0, the end of the window, to 8, its beginning; node 4 is the middle. */
double chebyshev_time(double from, double to, int node);

/* The coefficients c[CHEBYSHEV_NODES] of the polynomial through f[CHEBYSHEV_NODES] at the nodes. */
void chebyshev_coefficients(const double *f, double *c);

/* Its coefficients of powers of the time from the middle on, in a window of twice the half length. */
void chebyshev_powers(const double *c, double half, double *power);

#endif
