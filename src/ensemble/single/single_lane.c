#include "single/single_lane.h"

#include "series.h"
#include "series_limit.h"

double single_power(int k, double n, const double *a, const double *c) {
  return series_power(k, n, a, c);
}

#define LIMIT(rule, ...)                                                                                               \
  double single_limit_##rule(int order, double step, const double *u, const double *other, double number) {            \
    struct SeriesLimit limit = {.order = order, .step = step};                                                         \
    (void)other;                                                                                                       \
    (void)number;                                                                                                      \
    series_limit_##rule(&limit, __VA_ARGS__);                                                                          \
    return limit.step;                                                                                                 \
  }

LIMIT(exponential, u, "")
LIMIT(hyperbolic, u, "")
LIMIT(bounded, u, "")
LIMIT(tanh, u)
LIMIT(tangent, u)
LIMIT(positive, u, "")
LIMIT(quotient, u, number)
LIMIT(root, u, number)
LIMIT(whole_power, u, number)
LIMIT(division, u, other, number)
LIMIT(power, u, number)
LIMIT(sign, u, "")
LIMIT(angle, u, other)
