#include "algebra/quadrature.h"

#include <math.h>

/*
 * Returns the Legendre polynomial P_n(x), and its derivative, by the three-term recurrence
 *  k P_k = (2 k - 1) x P_(k-1) - (k - 1) P_(k-2).
 */
static long double legendre(size_t degree, long double x, long double *derivative) {
  long double before = 1.0L, value = x;
  for (size_t k = 2; k <= degree; k++) {
    long double next = ((long double)(2 * k - 1) * x * value - (long double)(k - 1) * before) / (long double)k;
    before = value;
    value = next;
  }
  *derivative = (long double)degree * (x * value - before) / (x * x - 1.0L);
  return value;
}

/* Finds each zero of P_n by Newton's method from Tricomi's estimate, in about four steps; ten leave a margin. */
void quadrature_rule(size_t count, double *nodes, double *weights) {
  enum { NEWTON_STEPS = 10 };
  for (size_t i = 0; i < count; i++) {
    long double x = cosl(acosl(-1.0L) * ((long double)(count - 1 - i) + 0.75L) / ((long double)count + 0.5L)), slope;
    for (int step = 0; step < NEWTON_STEPS; step++) {
      long double value = legendre(count, x, &slope);
      x -= value / slope;
    }
    legendre(count, x, &slope);
    nodes[i] = (double)((1.0L + x) / 2.0L);
    weights[i] = (double)(1.0L / ((1.0L - x * x) * slope * slope));
  }
}
