/* Order and steps of the Taylor method, for one run (taylor_interval.c) and for several at once (src/ensemble). */
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

/* A step. Its arrays have an element for each state variable. The state at the origin is x[i][0] + low[i]. */
struct TaylorStep {
  int64_t order;
  double tolerance;     /* local_tolerance() */
  Condition is_limited; /* something other than the size of the coefficients limits the step */
  Series *x;            /* coefficients of the state */
  Real *low;            /* rounding error of the state at the origin */
  /* The changes of the state over the step, and d state / dt at its end. */
  Real *term, *derivative;
  Real *unit;         /* 1 / taylor_scale() at the origin */
  Real *state, *rate; /* workspace: a state, and the derivatives of the polynomials */
};

/* Returns the scale of state variable i: its absolute value at the origin, at least its nominal value. */
static inline Real taylor_scale(const struct TaylorStep *step, size_t i) {
  Real size = FUNCTION(fabs)(step->x[i][0]);
  return WHERE(size < lagrangian.steps.nominal[i], lagrangian.steps.nominal[i], size);
}

static inline void taylor_measure_scales(const struct TaylorStep *step) {
  for (size_t i = 0; i < lagrangian.state_count; i++) step->unit[i] = 1.0 / taylor_scale(step, i);
}

/* Combines Horner's sums over even and odd powers into the change of the state. At odd orders (j = 1) it adds x[1]. */
static inline Real taylor_end_of_change(const Real *x, int64_t j, Pair sum, Real s) {
  Real change = (pair_second(sum) * s + pair_first(sum)) * s;
  return j == 1 ? (change + x[1]) * s : change;
}

/* Returns the change of state variable i from the origin to s after it, by Horner's rule for even and odd powers. */
static inline Real taylor_change(const struct TaylorStep *step, size_t i, Real s) {
  const Real *x = step->x[i], square = s * s;
  int64_t j = step->order;
  Pair sum = pair_at(x + j - 1);
  for (j -= 2; j > 1; j -= 2) sum = pair_sum(pair_multiple(sum, square), pair_at(x + j - 1));
  return taylor_end_of_change(x, j, sum, s);
}

/* Returns the same to equal bits, and sets step->rate[i], the time derivative at s, alongside. */
static inline Real taylor_change_and_rate(const struct TaylorStep *step, size_t i, Real s) {
  const Real *x = step->x[i], square = s * s;
  int64_t j = step->order;
  Pair sum = pair_at(x + j - 1), by_square = pair_multiple(sum, REAL(0.0));
  for (j -= 2; j > 1; j -= 2) {
    by_square = pair_sum(pair_multiple(by_square, square), sum);
    sum = pair_sum(pair_multiple(sum, square), pair_at(x + j - 1));
  }
  Real value = pair_second(sum) * s + pair_first(sum);
  Real slope = 2.0 * s * (pair_second(by_square) * s + pair_first(by_square)) + pair_second(sum);
  if (j == 1) {
    slope = slope * s + value;
    value = value * s + x[1];
  }
  step->rate[i] = slope * s + value;
  return value * s;
}

/*
 * Moves the origin by term with compensated summation; low takes the rounding error. Returns the largest change in
 * units of the scales.
 */
static inline Real taylor_move(const struct TaylorStep *step) {
  Real largest = REAL(0.0);
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    Real before = step->x[i][0], term = step->term[i] + step->low[i];
    Real sum = before + term, part = sum - before, moved = FUNCTION(fabs)(term) * step->unit[i];
    largest = WHERE(moved > largest, moved, largest);
    step->low[i] = (before - (sum - part)) + (term - part);
    step->x[i][0] = sum;
  }
  return largest;
}
