/* What the steps of Taylor series follow from, of one run (taylor_reach.c) and of several at once (src/ensemble). */
#ifndef TAYLOR_RULE_H
#define TAYLOR_RULE_H

#include <math.h>
#include <stdint.h>

#include "series.h"

enum { LOWEST_ORDER = 4, HIGHEST_ORDER = SERIES_LENGTH - 2 };
enum { CRAWL_STEPS = 1000 }; /* so many steps of one kind move a system further than the tolerance */

/* A step of the promised length has a defect of about a third of the order times the tolerance. */
static const double defect_margin = 3.0;
/* The share of its scale by which the state moves where a kink is crossed. */
static const double crossing_share = 1e-12;
/* Polynomial motions have no length of their own. */
static const double horizon = 1e4;
/* Rounding of the right side at the end of the step, in units of the last place, and of what rounding of the state does. */
static const double rounding = 100.0, rounding_margin = 10.0;
/* The shares of a step at which its defect is measured beside its end, where the step is short for another reason. */
static const double places_of_defects[] = {0.15, 0.35, 0.55, 0.75, 0.9};

/* Over a step whose length fast modes set, the terms of the series fall by less than this from one to the next; else by e^2. */
enum { FALL_OF_FAST = 4 };

enum { DEFECT_PLACES = sizeof places_of_defects / sizeof *places_of_defects };

/* The tolerance of a local error: errors of its order add up to more than it; see tests/solvers/test_motion.py. */
static inline double local_tolerance(double tolerance) {
  double local = 0.1 * tolerance;
  return local > 1e-17 ? local : 1e-17;
}

/* The order that the tolerance of a local error asks for. */
static inline int64_t order_for(double local) {
  double order = ceil(1.0 - 0.5 * log(local));
  return (int64_t)fmin(fmax(order, LOWEST_ORDER), HIGHEST_ORDER);
}

#endif
