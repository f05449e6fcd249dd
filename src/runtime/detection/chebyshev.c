#include "detection/chebyshev.h"

#include <math.h>

#include "arithmetic.h"

/* cos(pi k / 8) */
static const double cosines[CHEBYSHEV_NODES] = {
    1.0, 0.92387953251128675613,  0.70710678118654752440,  0.38268343236508977173,
    0.0, -0.38268343236508977173, -0.70710678118654752440, -0.92387953251128675613,
    -1.0};

Real chebyshev_time(Real from, Real to, int node) {
  if (node == 0) return to;
  if (node == CHEBYSHEV_DEGREE) return from;
  return from + 0.5 * (1.0 + cosines[node]) * (to - from);
}

void chebyshev_times(Real from, Real to, Real *times) {
  for (int node = 0; node < CHEBYSHEV_NODES; node++) times[node] = chebyshev_time(from, to, node);
}

/* Makes a discrete cosine transform, by sums and differences of nodes symmetric about the middle. */
void chebyshev_coefficients(const Real *f, Real *c) {
  const double share = 2.0 / CHEBYSHEV_DEGREE, narrow = cosines[1], half = cosines[2], wide = cosines[3];
  Real end = 0.5 * (f[0] + f[8]), outer = f[1] + f[7], next = f[2] + f[6], inner = f[3] + f[5];
  Real ends = end + f[4], pairs = outer + inner, centre = end - f[4], slope = half * (outer - inner);
  c[0] = 0.5 * share * ((ends + next) + pairs);
  c[2] = share * (centre + slope);
  c[4] = share * (ends - next);
  c[6] = share * (centre - slope);
  c[8] = 0.5 * share * ((ends + next) - pairs);
  Real odd_end = 0.5 * (f[0] - f[8]), odd_outer = f[1] - f[7], odd_next = half * (f[2] - f[6]), odd_inner = f[3] - f[5];
  Real first = odd_end + odd_next, second = odd_end - odd_next;
  Real of_first = narrow * odd_outer + wide * odd_inner, of_second = wide * odd_outer - narrow * odd_inner;
  c[1] = share * (first + of_first);
  c[3] = share * (second + of_second);
  c[5] = share * (second - of_second);
  c[7] = share * (first - of_first);
}

Real chebyshev_range(const Real *c) {
  Real sum = REAL(0.0);
  for (int k = 1; k <= CHEBYSHEV_DEGREE; k++) sum += fabs(c[k]);
  return sum;
}

Real chebyshev_tail(const Real *c) {
  return fabs(c[CHEBYSHEV_DEGREE]) + fabs(c[CHEBYSHEV_DEGREE - 1]);
}

void chebyshev_derivative(const Real *c, Real *d) {
  d[CHEBYSHEV_DEGREE] = REAL(0.0);
  d[CHEBYSHEV_DEGREE - 1] = 2.0 * CHEBYSHEV_DEGREE * c[CHEBYSHEV_DEGREE];
  for (int k = CHEBYSHEV_DEGREE - 2; k >= 0; k--) d[k] = d[k + 2] + 2.0 * (k + 1) * c[k + 1];
  d[0] *= 0.5;
}

/* Evaluates the sum by Clenshaw's algorithm. */
Real chebyshev_value(const Real *c, Real slot) {
  Real next = REAL(0.0), sum = REAL(0.0);
  for (int k = CHEBYSHEV_DEGREE; k > 0; k--) {
    Real before = sum;
    sum = c[k] + 2.0 * slot * sum - next;
    next = before;
  }
  return c[0] + slot * sum - next;
}

void chebyshev_powers(const Real *c, Real half, Real *power) {
  /* Row j: T_j by powers of s, from T_(j+1) = 2 s T_j - T_(j-1). */
  static const double polynomials[CHEBYSHEV_DEGREE + 1][CHEBYSHEV_DEGREE + 1] = {{1},
                                                                                 {0, 1},
                                                                                 {-1, 0, 2},
                                                                                 {0, -3, 0, 4},
                                                                                 {1, 0, -8, 0, 8},
                                                                                 {0, 5, 0, -20, 0, 16},
                                                                                 {-1, 0, 18, 0, -48, 0, 32},
                                                                                 {0, -7, 0, 56, 0, -112, 0, 64},
                                                                                 {1, 0, -32, 0, 160, 0, -256, 0, 128}};
  Real scale = REAL(1.0);
  for (int k = 0; k <= CHEBYSHEV_DEGREE; k++, scale /= half) {
    Real sum = REAL(0.0);
    for (int j = k; j <= CHEBYSHEV_DEGREE; j++) sum += c[j] * polynomials[j][k];
    power[k] = sum * scale;
  }
}
