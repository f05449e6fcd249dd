/*
 * Step limits of include/series_limit.h for lanes, under the same names. A vectorized bound decides most lanes; the
 * others are decided one by one.
 */
#ifndef SERIES_LIMIT_H
#define SERIES_LIMIT_H

#include "lane_series.h"
#include "single/single_lane.h"

struct SeriesLimit {
  int order;      /* order of the polynomials */
  Lanes step;     /* the step, which the functions below shorten */
  Mask shortened; /* lanes in which they did so */
};

/* Undoes the changes outside the lanes. */
LANES_INLINE void lane_limit_keep(struct SeriesLimit *limit, struct SeriesLimit before, Mask lanes) {
  limit->step = lanes_select(lanes, limit->step, before.step);
  limit->shortened = before.shortened | (limit->shortened & lanes);
}

#define LIMIT_WHERE(condition, ...)                                                                                    \
  do {                                                                                                                 \
    struct SeriesLimit before_limit = *limit;                                                                          \
    __VA_ARGS__;                                                                                                       \
    lane_limit_keep(limit, before_limit, condition);                                                                   \
  } while (0)

/* Applies the rule in lanes where the excursion of u from u_0 may exceed the bound. other: a second row, or NULL. */
void lane_limit(struct SeriesLimit *limit, SingleLimit *rule, Lanes bound, const Lanes *u, const Lanes *other,
                Lanes number);

/*
 * Excursions that no rule limits: LANE_LIMIT_RANGE of arguments of exp and the like, LANE_LIMIT_SHARE of the distance
 * to 0. Both lie below the limits of series_limit.c, so that results are the same.
 */
#define LANE_LIMIT_RANGE LANES_OF(4.0)
#define LANE_LIMIT_SHARE 0.9

LANES_INLINE Lanes lane_limit_bound(const Lanes *u, double share) {
  return LANE_LIMIT_SHARE * (share < 1.0 ? share : 1.0) * lanes_absolute(u[0]);
}

/* Defines a limit by the rule for single lanes of the same name. The last argument lists the further parameters. */
#define LANE_LIMIT(name, bound, other, number, ...)                                                                    \
  LANES_INLINE void series_limit_##name(struct SeriesLimit *limit, const Lanes *u __VA_ARGS__) {                       \
    lane_limit(limit, single_limit_##name, bound, u, other, number);                                                   \
  }
#define LANE_LIMIT_FUNCTION , const char *function __attribute__((unused))
LANE_LIMIT(exponential, LANE_LIMIT_RANGE, NULL, (Lanes){0}, LANE_LIMIT_FUNCTION)
LANE_LIMIT(hyperbolic, LANE_LIMIT_RANGE, NULL, (Lanes){0}, LANE_LIMIT_FUNCTION)
LANE_LIMIT(bounded, LANE_LIMIT_RANGE, NULL, (Lanes){0}, LANE_LIMIT_FUNCTION)
LANE_LIMIT(tanh, LANE_LIMIT_RANGE, NULL, (Lanes){0}, )
LANE_LIMIT(tangent, (Lanes){0}, NULL, (Lanes){0}, )
LANE_LIMIT(positive, lane_limit_bound(u, 1.0), NULL, (Lanes){0}, LANE_LIMIT_FUNCTION)
LANE_LIMIT(sign, lane_limit_bound(u, 1.0), NULL, (Lanes){0}, LANE_LIMIT_FUNCTION)
LANE_LIMIT(angle, lane_limit_bound(u, 1.0), x, (Lanes){0}, , const Lanes *x)
LANE_LIMIT(quotient, lane_limit_bound(u, share), NULL, LANES_OF(share), , double share)
LANE_LIMIT(root, lane_limit_bound(u, share), NULL, LANES_OF(share), , double share)
LANE_LIMIT(whole_power, lane_limit_bound(u, share), NULL, LANES_OF(share), , double share)
LANE_LIMIT(division, lane_limit_bound(u, share), numerator, LANES_OF(share), , const Lanes *numerator, double share)
LANE_LIMIT(power, (Lanes){0}, NULL, exponent, , Lanes exponent)
#undef LANE_LIMIT
#undef LANE_LIMIT_FUNCTION

#endif
