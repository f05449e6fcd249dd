/* The defect of a Taylor step, for one run (taylor_interval.c) and for several (src/ensemble). */
#pragma once

#include <float.h>

#include "methods/taylor_rule.h"

/* Defined where this file is included: evaluates d state / dt at step->state. False if it does not exist. */
static Condition evaluate_derivative(const struct TaylorStep *step, Real s, Real *derivative);

/* Does so at the origin's state plus step->term, perturbed by the relative amount share with alternating signs. */
static Condition right_side(const struct TaylorStep *step, Real s, double share, Real *derivative) {
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    step->state[i] = step->x[i][0] + (step->term[i] + step->low[i]);
    if (share != 0.0) step->state[i] *= 1.0 + (i % 2 == 0 ? share : -share);
  }
  return evaluate_derivative(step, s, derivative);
}

/*
 * Returns the largest defect * step that the tolerance allows, in units of the scales. If the coefficients limit the
 * step, the defect grows with s^order, and its integral, the error, is smaller by order + 1.
 */
static Real allowed_defect(const struct TaylorStep *step) {
  return WHERE(step->is_limited, step->tolerance, defect_margin * (double)(step->order + 1) * step->tolerance);
}

/* Returns the larger one; INFINITY if size is NaN. */
static Real larger_or_infinite(Real largest, Real size) {
  return WHERE(size <= largest, largest, WHERE(size < INFINITY, size, INFINITY));
}

/*
 * Returns the largest defect at s times s, in units of the scales and of allowed_defect(); INFINITY if it does not
 * exist. The coordinates have none: their series are the integrals of those of the velocities. Leaves the changes and
 * rates in term and derivative.
 */
static Real defect(const struct TaylorStep *step, Real s) {
  size_t first = lagrangian.coordinate_count, states = lagrangian.state_count;
  Real largest = REAL(0.0);
  for (size_t i = 0; i < first; i++) step->term[i] = taylor_change(step, i, s);
  for (size_t i = first; i < states; i++) step->term[i] = taylor_change_and_rate(step, i, s);
  Condition exists = right_side(step, s, 0.0, step->derivative);
  for (size_t i = first; i < states; i++) {
    Real exact = step->derivative[i];
    Real difference = FUNCTION(fabs)(exact - step->rate[i]) - rounding * DBL_EPSILON * FUNCTION(fabs)(exact);
    largest = larger_or_infinite(largest, difference * s * step->unit[i]);
  }
  return WHERE(exists, largest / allowed_defect(step), INFINITY);
}

/*
 * Returns the change of the right side by rounding of the state at s, in the units of defect(), which must precede the
 * call. It is large where forces are differences of large numbers, as in stiff springs.
 */
static Real rounding_of_right_side(const struct TaylorStep *step, Real s) {
  Real largest = REAL(0.0);
  Condition exists = right_side(step, s, 4.0 * DBL_EPSILON, step->rate);
  exists = BOTH(exists, right_side(step, s, 0.0, step->derivative));
  for (size_t i = lagrangian.coordinate_count; i < lagrangian.state_count; i++) {
    Real moved = FUNCTION(fabs)(step->rate[i] - step->derivative[i]) * s * step->unit[i];
    largest = WHERE(moved > largest, moved, largest);
  }
  return WHERE(exists, largest / allowed_defect(step), 0.0);
}
