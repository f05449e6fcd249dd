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

LANES_INLINE void series_limit_exponential(struct SeriesLimit *limit, const Lanes *u, const char *function) {
  (void)function;
  lane_limit(limit, single_limit_exponential, LANE_LIMIT_RANGE, u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_hyperbolic(struct SeriesLimit *limit, const Lanes *u, const char *function) {
  (void)function;
  lane_limit(limit, single_limit_hyperbolic, LANE_LIMIT_RANGE, u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_bounded(struct SeriesLimit *limit, const Lanes *u, const char *function) {
  (void)function;
  lane_limit(limit, single_limit_bounded, LANE_LIMIT_RANGE, u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_tanh(struct SeriesLimit *limit, const Lanes *u) {
  lane_limit(limit, single_limit_tanh, LANE_LIMIT_RANGE, u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_tangent(struct SeriesLimit *limit, const Lanes *u) {
  lane_limit(limit, single_limit_tangent, (Lanes){0}, u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_positive(struct SeriesLimit *limit, const Lanes *u, const char *function) {
  (void)function;
  lane_limit(limit, single_limit_positive, LANE_LIMIT_SHARE * lanes_absolute(u[0]), u, NULL, (Lanes){0});
}

LANES_INLINE Lanes lane_limit_bound(const Lanes *u, double share) {
  return LANE_LIMIT_SHARE * (share < 1.0 ? share : 1.0) * lanes_absolute(u[0]);
}

LANES_INLINE void series_limit_quotient(struct SeriesLimit *limit, const Lanes *u, double share) {
  lane_limit(limit, single_limit_quotient, lane_limit_bound(u, share), u, NULL, LANES_OF(share));
}

LANES_INLINE void series_limit_root(struct SeriesLimit *limit, const Lanes *u, double share) {
  lane_limit(limit, single_limit_root, lane_limit_bound(u, share), u, NULL, LANES_OF(share));
}

LANES_INLINE void series_limit_whole_power(struct SeriesLimit *limit, const Lanes *u, double share) {
  lane_limit(limit, single_limit_whole_power, lane_limit_bound(u, share), u, NULL, LANES_OF(share));
}

LANES_INLINE void series_limit_division(struct SeriesLimit *limit, const Lanes *u, const Lanes *numerator,
                                        double share) {
  lane_limit(limit, single_limit_division, lane_limit_bound(u, share), u, numerator, LANES_OF(share));
}

LANES_INLINE void series_limit_power(struct SeriesLimit *limit, const Lanes *u, Lanes exponent) {
  lane_limit(limit, single_limit_power, (Lanes){0}, u, NULL, exponent);
}

LANES_INLINE void series_limit_sign(struct SeriesLimit *limit, const Lanes *u, const char *function) {
  (void)function;
  lane_limit(limit, single_limit_sign, LANE_LIMIT_SHARE * lanes_absolute(u[0]), u, NULL, (Lanes){0});
}

LANES_INLINE void series_limit_angle(struct SeriesLimit *limit, const Lanes *y, const Lanes *x) {
  lane_limit(limit, single_limit_angle, LANE_LIMIT_SHARE * lanes_absolute(y[0]), y, x, (Lanes){0});
}

#endif
