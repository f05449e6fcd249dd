/* Order and step of the Taylor method, for one run (taylor_interval.c) and for several at once (src/ensemble). */
#pragma once

#include <math.h>
#include <stdint.h>

#include "lagrangian.h"

/* Orders that a tolerance may select. A series has one coefficient more for the state. */
enum { LOWEST_ORDER = 4, HIGHEST_ORDER = SERIES_LENGTH - 2 };
enum {
  STAGNATION_STEPS = 1000
}; /* steps of one kind: if they move the system by less than the tolerance, it stagnates */

/*
 * The defect may exceed (order + 1) * tolerance, where the error equals the tolerance, by this factor. Steps of the
 * predicted length have a defect of about order * tolerance / 3.
 */
static const double defect_margin = 3.0;
/* The change of the state, relative to its scale, in a step that crosses a kink, a jump or a root of 0. */
static const double crossing_share = 1e-12;
/* The longest step in communication steps if no stop time is defined: series of polynomial motions give no length. */
static const double look_ahead = 1e4;
/* Rounding error of the right side in the defect, in units of the last place; and margin of that of the state. */
static const double rounding = 100.0, rounding_margin = 10.0;
/* Fractions of the step at which the defect is also measured if the coefficients do not limit the step. */
static const double defect_points[] = {0.15, 0.35, 0.55, 0.75, 0.9};

/* Ratio of consecutive terms at the end of the step: smaller if fast modes limit the step, otherwise larger. */
enum { FALL_OF_FAST = 3 };

enum { DEFECT_POINTS = sizeof defect_points / sizeof *defect_points };

/* Returns the tolerance of the error in one step: errors of many steps add up (tests/solvers/test_motion.py). */
static inline double local_tolerance(double tolerance) {
  double local = 0.1 * tolerance;
  return local > 1e-17 ? local : 1e-17;
}

/*
 * Returns the arithmetic operations of a step of this order, as lagrangian.steps.operations counts them. The constants
 * were fitted to measured times of systems with one to ten coordinates, at 0.3 ns an operation.
 */
static inline double work_of_series(double order) {
  const struct OperationCounts *count = &lagrangian.steps.operations;
  double states = (double)lagrangian.state_count;
  return 380.0 + 4.0 * count->derivatives +
         order * (0.5 * count->series + 1.5 * states + 0.45 * order * count->recurrences);
}

/* Order and step for a local tolerance. */
struct SeriesRule {
  double tolerance;
  int64_t order;
  double margin; /* log2 of the ratio of the radius of convergence to the step */
};

/*
 * Chooses the order p of least work per unit of time for the local tolerance (A. Jorba, M. Zou, 2005, section 3).
 *
 * With a step of exp(-fall) times the radius of convergence, each term is exp(-fall) times the one before. The first
 * term left out is about exp(-fall (p + 1)), which gives the fall for each order. If the work of a step grows with p^2,
 * a fall of 2 is optimal, as in the paper. If it grows less, higher orders with longer steps and a smaller fall are
 * cheaper. The search starts at the paper's order and ends where the work begins to grow. The term 0.7 / (p - 1) is the
 * paper's safety factor.
 */
static inline struct SeriesRule rule_for(double local) {
  const double highest_fall = 2.0, near_rounding = 1e-15; /* below it, rounding outweighs what longer steps save */
  double lowest_fall = local < near_rounding ? highest_fall : 1.5;
  const double reserve = 5.0; /* natural logarithms between the tolerance and the first term left out */
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
