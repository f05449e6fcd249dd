#include "algebra/quadrature.h"

#include <math.h>

/* The Legendre polynomial of a degree and its derivative, by the recurrence of three terms. */
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

/* Each zero by Newton's method from Tricomi's estimate, which it reaches in some four steps. */
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
