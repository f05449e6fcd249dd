/* What the steps of Taylor series follow from, of one run (taylor_reach.c) and of several at once (src/ensemble). */
#ifndef TAYLOR_RULE_H
#define TAYLOR_RULE_H

#include <math.h>
#include <stdint.h>

#include "lagrangian.h"

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

/* Over a step whose length fast modes set, the terms of the series fall by less than this from one to the next; else by more. */
enum { FALL_OF_FAST = 3 };

enum { DEFECT_PLACES = sizeof places_of_defects / sizeof *places_of_defects };

/* The tolerance of a local error: errors of its order add up to more than it; see tests/solvers/test_motion.py. */
static inline double local_tolerance(double tolerance) {
  double local = 0.1 * tolerance;
  return local > 1e-17 ? local : 1e-17;
}

/*
 * Operations of a step of the series, see lagrangian.steps.operations. The constants were fitted to measured times, 0.3 ns an
 * operation, of systems with one to ten coordinates.
 */
static inline double work_of_series(double order) {
  const struct OperationCounts *count = &lagrangian.steps.operations;
  double states = (double)lagrangian.state_count;
  return 380.0 + 4.0 * count->derivatives +
         order * (0.5 * count->series + 1.5 * states + 0.45 * order * count->recurrences);
}

/* What the tolerance of a local error asks for. */
struct SeriesRule {
  double tolerance;
  int64_t order;
  double margin; /* the logarithm to base 2 of the share of its radius of convergence that a step may go */
};

/*
 * A series of order p whose terms fall by e^-fall from one to the next goes e^-fall of its radius of convergence; its first
 * term that is left out is e^(-fall (p + 1)). Where the work of a step grows with p^2, the least for a way is that with a fall
 * of 2 (A. Jorba, M. Zou, 2005, section 3.1); where it hardly grows with the order, longer steps of a higher order are less.
 */
static inline struct SeriesRule rule_for(double local) {
  const double highest_fall = 2.0, near_rounding = 1e-15; /* where longer steps would round more than they err */
  double lowest_fall = local < near_rounding ? highest_fall : 1.5;
  const double reserve = 5.0; /* of the first term that is left out, below the tolerance */
  double digits = -log(local), least = INFINITY;
  struct SeriesRule rule = {.tolerance = local};
  int64_t lowest = (int64_t)fmin(fmax(ceil(1.0 + digits / highest_fall), LOWEST_ORDER), HIGHEST_ORDER);
  for (int64_t order = lowest; order <= HIGHEST_ORDER; order++) {
    double fall = fmax((digits + reserve) / (double)(order + 1), lowest_fall);
    double work = work_of_series((double)order) * exp(fall);
    if (work >= least) break;
    least = work;
    rule.order = order;
    rule.margin = (fall + 0.7 / (double)(order - 1)) / 0.69314718055994530942;
  }
  return rule;
}

#endif
