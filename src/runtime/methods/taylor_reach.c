/*
 * The step of the Taylor solver. The last two coefficients promise a step (A. Jorba, M. Zou, 2005, section 3.2), but
 * they may vanish by symmetry or because a function is flat at the origin. So the step is a promise only: the functions
 * in the equations limit it (series_limit.h), and its defect is measured, the difference between x'(t) of the
 * polynomials and the right side of the equations of motion.
 */
#include "methods/taylor_reach.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "evaluation/inputs.h"

/*
 * The change of state variable i from the origin to s after it, as taylor_change() computes it, and its time derivative
 * there: each step of Horner's rule has its derivative beside it.
 */
static double change_and_rate(const struct Taylor *taylor, size_t i, double s, double *rate) {
  const double *x = taylor->x[i], square = s * s;
  int64_t j = taylor->saved->order;
  Pair sum = pair_at(x + j - 1), by_square = pair_multiple(sum, 0.0);
  for (j -= 2; j > 1; j -= 2) {
    by_square = pair_sum(pair_multiple(by_square, square), sum);
    sum = pair_sum(pair_multiple(sum, square), pair_at(x + j - 1));
  }
  double value = pair_second(sum) * s + pair_first(sum);
  double slope = 2.0 * s * (pair_second(by_square) * s + pair_first(by_square)) + pair_second(sum);
  if (j == 1) {
    slope = slope * s + value;
    value = value * s + x[1];
  }
  *rate = slope * s + value;
  return value * s;
}

/* In units of the variables' scales: 1 / scale of each. */
void taylor_measure_scales(struct Taylor *taylor) {
  for (size_t i = 0; i < lagrangian.state_count; i++) taylor->unit[i] = 1.0 / taylor_scale(taylor, i);
}

/* The largest coefficients of an order and of the one before, in units of the variables' scales. */
static void norms(const struct Taylor *taylor, int64_t order, double *last, double *before) {
  *last = *before = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double size = fabs(taylor->x[i][order]) * taylor->unit[i],
           size_before = fabs(taylor->x[i][order - 1]) * taylor->unit[i];
    if (size > *last || isnan(size)) *last = size; /* a NaN stays */
    if (size_before > *before || isnan(size_before)) *before = size_before;
  }
}

/*
 * The logarithm to base 2 of a positive number to 0.01, and 2^x to 1 %: more than a step length needs, without the time
 * of the library's functions, and the same on all machines. Both work on the exponent of an IEEE 754 double.
 */
static double rough_logarithm(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  double exponent = (double)((int)(bits >> 52) - 1023), mantissa;
  bits = (bits & 0xfffffffffffffu) | (uint64_t)1023 << 52;
  memcpy(&mantissa, &bits, sizeof mantissa); /* from 1 to 2 */
  return exponent + 1.0 + (0.5 * mantissa - 1.0) * (2.65 - 0.66 * mantissa);
}

static double rough_power_of_two(double x) {
  if (x > 1000.0) return INFINITY;
  if (x < -1000.0) return 0.0;
  int exponent = (int)(x + 1023.0);
  double rest = x + 1023.0 - exponent, power;
  uint64_t bits = (uint64_t)exponent << 52;
  memcpy(&power, &bits, sizeof power);
  return power * (1.0 + rest * (0.66 + 0.34 * rest));
}

/* Where the last two terms that do not vanish are as small as the tolerance asks; 0 where they are not finite. */
static double promised_step(const struct Taylor *taylor) {
  int64_t order = taylor->saved->order, lowest = order / 2;
  double last, before;
  for (norms(taylor, order, &last, &before); last + before == 0.0; norms(taylor, order, &last, &before))
    if (--order <= lowest) return INFINITY;
  if (!isfinite(last + before)) return 0.0;
  double power = (double)order;
  double of_last = last > 0.0 ? rough_logarithm(last) / power : -INFINITY;
  double of_before = before > 0.0 ? rough_logarithm(before) / (power - 1.0) : -INFINITY;
  return rough_power_of_two(-(of_last > of_before ? of_last : of_before) - taylor->rule.margin);
}

int taylor_start(struct Instance *instance, const struct Taylor *taylor, double time, double *derivative) {
  struct Point point = instance_point(instance);
  point.time = time;
  point.state = instance->work;
  if (instance->situation->input_derivatives_set) {
    double *input = instance->work + lagrangian.state_count;
    evaluate_inputs(instance, time, input);
    point.input = input;
  }
  return lagrangian.taylor.start(&point, derivative, taylor->work);
}

/*
 * The right side of the equations of motion at s after the origin, at the state that taylor->term leads to, with each
 * of its numbers made larger or smaller by the share; false where it does not exist.
 */
static bool right_side(struct Instance *instance, const struct Taylor *taylor, double s, double share,
                       double *derivative) {
  double *state = instance->work;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    state[i] = taylor->x[i][0] + (taylor->term[i] + taylor->low[i]);
    if (share != 0.0) state[i] *= 1.0 + (i % 2 == 0 ? share : -share);
  }
  return taylor_start(instance, taylor, taylor->span->start + s, derivative) == 0;
}

/*
 * The defect times the step that the tolerance allows, in units of the variables' scales. Where the coefficients set the
 * step, the defect grows with the power order, so that the error is smaller by order + 1.
 */
static double allowed_defect(const struct Taylor *taylor) {
  double size = taylor->rule.tolerance;
  return taylor->is_limited ? size : defect_margin * (double)(taylor->saved->order + 1) * size;
}

/*
 * The largest defect at s, as the change that it makes over s in units of the variables' scales and of what is allowed.
 * The coordinates follow from the velocities.
 */
static double defect(struct Instance *instance, struct Taylor *taylor, double s) {
  size_t first = lagrangian.coordinate_count, states = lagrangian.state_count;
  double largest = 0.0, *rate = instance->work + states + lagrangian.input_count;
  for (size_t i = 0; i < first; i++) taylor->term[i] = taylor_change(taylor, i, s);
  for (size_t i = first; i < states; i++) taylor->term[i] = change_and_rate(taylor, i, s, &rate[i]);
  if (!right_side(instance, taylor, s, 0.0, taylor->derivative)) return INFINITY;
  for (size_t i = first; i < states; i++) {
    double exact = taylor->derivative[i];
    double difference = fabs(exact - rate[i]) - rounding * DBL_EPSILON * fabs(exact);
    double share = difference * s * taylor->unit[i];
    if (!(share <= largest)) largest = isfinite(share) ? share : INFINITY;
  }
  return largest / allowed_defect(taylor);
}

/*
 * What rounding of the state at s, where defect() has just been, makes of the right side, in the units of defect(): a
 * stiff spring's force is the difference of large numbers.
 */
static double rounding_of_right_side(struct Instance *instance, struct Taylor *taylor, double s) {
  size_t states = lagrangian.state_count;
  double *other = instance->work + states + lagrangian.input_count, largest = 0.0;
  if (!right_side(instance, taylor, s, 4.0 * DBL_EPSILON, other)) return 0.0;
  if (!right_side(instance, taylor, s, 0.0, taylor->derivative)) return 0.0;
  for (size_t i = lagrangian.coordinate_count; i < states; i++)
    largest = fmax(largest, fabs(other[i] - taylor->derivative[i]) * s * taylor->unit[i]);
  return largest / allowed_defect(taylor);
}

/* The larger of the defects inside the step and at its end. */
static double defect_over(struct Instance *instance, struct Taylor *taylor, double s) {
  double largest = 0.0;
  for (int i = 0; i < DEFECT_PLACES && largest <= 1.0; i++)
    largest = fmax(largest, defect(instance, taylor, places_of_defects[i] * s));
  return fmax(largest, defect(instance, taylor, s));
}

/* The step as far as the functions in the equations allow it. */
static struct SeriesLimit limited(const struct Instance *instance, const struct Taylor *taylor, double step,
                                  bool crosses) {
  struct SeriesLimit limit = {.order = (int)taylor->saved->order - 1, .step = step, .crosses = crosses};
  if (lagrangian.taylor.limit == NULL) return limit;
  struct Point point = instance_point(instance);
  point.time = taylor->span->start;
  lagrangian.taylor.limit(&point, (const Series *)taylor->input, (const Series *)taylor->x,
                          (const Series *)taylor->work, &limit);
  return limit;
}

/* Steps below are no steps in a time of so many digits; a motion that asks for them runs into a singular point. */
static double smallest_step(const struct Taylor *taylor) {
  return 8.0 * DBL_EPSILON * fabs(taylor->span->start);
}

/* The next origin is a number, so that the time does not drift. */
static double exact_reach(const struct Taylor *taylor, double step) {
  return taylor->span->start + step - taylor->span->start;
}

/*
 * A root has no series where its operand is 0, but leaves the accelerations finite: the state goes on along its first
 * terms alone.
 */
static void cut_off(const struct Taylor *taylor) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    for (int64_t k = 2; k <= taylor->saved->order; k++) taylor->x[i][k] = 0.0;
}

/*
 * A point where a root, a kink or a jump has no series is approached by ever shorter steps, and crossed by one in which
 * the state moves by a millionth of a millionth of its scale, so that two such points are not taken for one, and in which
 * all that changes is less than the tolerance, or less than the rounding of time makes of it. Returns that step, whose
 * end was measured, or 0 where a step of the length that has a series does as well.
 */
static double crossing_step(struct Instance *instance, struct Taylor *taylor, double communication_step,
                            double length) {
  double step = crossing_share * communication_step, smallest = 2.0 * smallest_step(taylor);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    step = fmin(step, crossing_share * taylor_scale(taylor, i) / fabs(taylor->x[i][1]));
  step = fmax(step, smallest);
  if (length >= step) return 0.0;
  step = limited(instance, taylor, step, true).step;
  for (int trial = 0; trial < 4 && step > length; trial++) {
    step = exact_reach(taylor, step);
    double size = defect_over(instance, taylor, step);
    if (size <= 1.0) return step;
    if (step <= 2.0 * smallest && isfinite(size)) {
      cut_off(taylor); /* no more terms belong to so short a step than the rounding of time leaves */
      if (isfinite(defect(instance, taylor, step))) return step;
    }
    step = fmax(0.1 * step, fmin(step, smallest));
  }
  return 0.0;
}

/* Shortens the step until its defect is small. A defect that rounding explains stays in a shorter step too. */
static double shortened(struct Instance *instance, struct Taylor *taylor, double step) {
  double power = 1.0 / (double)(taylor->saved->order + 1);
  for (;;) {
    step = exact_reach(taylor, step);
    if (step <= smallest_step(taylor)) return 0.0;
    double size = taylor->is_limited ? defect_over(instance, taylor, step) : defect(instance, taylor, step);
    if (size <= 1.0) return step;
    if (isfinite(size) && size <= rounding_margin * rounding_of_right_side(instance, taylor, step)) return step;
    taylor->is_limited = true;
    step *= fmin(fmax(0.9 * pow(size, -power), 0.1), 0.8);
  }
}

void taylor_choose_reach(struct Instance *instance, struct Taylor *taylor, double communication_step) {
  struct TaylorSaved *saved = taylor->saved;
  const struct Situation *situation = instance->situation;
  double rest =
      situation->stop_time_defined ? situation->stop_time - taylor->span->start : horizon * communication_step;
  double promised = promised_step(taylor), step = promised;
  if (rest < communication_step) rest = communication_step;
  rest = fmin(rest, DBL_MAX - fabs(taylor->span->start)); /* no shorter step ends the search from an infinite one */
  if (rest < step) step = rest;
  if (lagrangian.steps.max_step < step) step = lagrangian.steps.max_step;
  struct SeriesLimit limit = limited(instance, taylor, step, false);
  instance->limited_by = limit.function;
  taylor->is_limited = limit.step < promised;
  double crossing = 0.0;
  if (promised == 0.0) cut_off(taylor);
  if (promised == 0.0 || limit.function != NULL)
    crossing = crossing_step(instance, taylor, communication_step, limit.step);
  taylor->crosses = crossing > 0.0;
  saved->reach = taylor->crosses ? crossing : shortened(instance, taylor, limit.step);
  taylor->is_measured = saved->reach > 0.0;
}
