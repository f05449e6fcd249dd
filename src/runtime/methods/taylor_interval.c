/*
 * Step size of the Taylor method, in three parts.
 *
 * 1. Prediction (A. Jorba, M. Zou, 2005, section 3). With the norms |x_j| in units of the state's scales, the
 *    radius of convergence is about r = min over j = p - 1, p of |x_j|^(-1/j). The step is r * 2^(-margin)
 *    (taylor_rule.h).
 *
 * 2. Bound. The last coefficients may vanish by symmetry, or because a function such as exp or tanh is flat at the
 * origin. series_limit.h bounds the step so that no elementary function in the equations can hide a change.
 *
 * 3. Defect check. The defect d(s) = x'(s) - f(s, x(s)) of the polynomial is evaluated at the end of the step. The step
 * is accepted if |d(s)| s in units of the scales is below the tolerance (allowed_defect()). If the coefficients do not
 * limit the step, the defect is also measured inside it. A larger defect shortens the step by a factor from 0.1 to 0.8.
 * So the loop ends: with an accepted step, or below the resolution of time, which is reported as a singularity. The
 * evaluation at the end serves the next step, so a step costs one series and, usually, one evaluation.
 */
#include "methods/taylor_interval.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "methods/taylor_defect.h"

/* Finds the largest coefficients of this order and of the one before, in units of the scales. A NaN is kept. */
static void norms(const struct Taylor *taylor, int64_t order, double *last, double *before) {
  *last = *before = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double size = fabs(taylor->step.x[i][order]) * taylor->step.unit[i],
           size_before = fabs(taylor->step.x[i][order - 1]) * taylor->step.unit[i];
    if (size > *last || isnan(size)) *last = size; /* so that a NaN stays */
    if (size_before > *before || isnan(size_before)) *before = size_before;
  }
}

/*
 * Returns log2(x) of a positive number to 0.01, and below 2^x to 1 %. A step length needs no more; these are faster
 * than the library's functions, and give equal bits on all machines. Both use the exponent of an IEEE 754 double.
 */
static double rough_logarithm(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  double exponent = (double)((int)(bits >> 52) - 1023), mantissa;
  bits = (bits & 0xfffffffffffffu) | (uint64_t)1023 << 52;
  memcpy(&mantissa, &bits, sizeof mantissa); /* in [1, 2) */
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

/*
 * Returns the predicted step from the last two orders that are not both 0. It is INFINITY if the upper half of the
 * orders vanishes, and 0 if a coefficient is not finite.
 */
static double predicted_step(const struct Taylor *taylor) {
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

int taylor_start(const struct Taylor *taylor, double time, double *derivative) {
  struct Instance *instance = taylor->instance;
  struct Point point = instance_point(instance);
  point.time = time;
  point.state = instance->work;
  if (instance->fmu_state->input_derivatives_set) {
    double *input = instance->work + lagrangian.state_count;
    evaluate_inputs(instance, time, input);
    point.input = input;
  }
  return lagrangian.taylor.start(&point, derivative, taylor->work);
}

static bool evaluate_derivative(const struct TaylorStep *step, double s, double *derivative) {
  const struct Taylor *taylor = (const struct Taylor *)step;
  return taylor_start(taylor, taylor->span->start + s, derivative) == 0;
}

/* Returns the largest defect inside the step and at its end; stops at the first one that is too large. */
static double defect_over(const struct Taylor *taylor, double s) {
  double largest = 0.0;
  for (int i = 0; i < DEFECT_POINTS && largest <= 1.0; i++)
    largest = fmax(largest, defect(&taylor->step, defect_points[i] * s));
  return fmax(largest, defect(&taylor->step, s));
}

/* Returns the step after the bounds by the functions in the equations (series_limit.h). */
static struct SeriesLimit limited(const struct Instance *instance, const struct Taylor *taylor, double step,
                                  bool crosses) {
  struct SeriesLimit limit = {.order = (int)taylor->saved->order - 1, .step = step, .crosses = crosses};
  if (lagrangian.taylor.limit == NULL) return limit;
  struct Point point = instance_point(instance);
  point.time = taylor->span->start;
  lagrangian.taylor.limit(&point, (const Series *)taylor->input, (const Series *)taylor->step.x,
                          (const Series *)taylor->work, &limit);
  return limit;
}

/* Returns the length below which rounding of time hides a step. Motions that need such steps run into a singularity. */
static double smallest_step(const struct Taylor *taylor) {
  return 8.0 * DBL_EPSILON * fabs(taylor->span->start);
}

/* Rounds the step so that origin + step is exact, and the time does not drift. */
static double exact_interval(const struct Taylor *taylor, double step) {
  return taylor->span->start + step - taylor->span->start;
}

/* Reduces the series to Euler's method: at 0 a root has no series, but the accelerations are finite. */
static void use_euler_step(const struct Taylor *taylor) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    for (int64_t k = 2; k <= taylor->saved->order; k++) taylor->step.x[i][k] = 0.0;
}

/*
 * Returns a step across a point at which a root, a kink or a jump has no series. It is 0 if a step of the length
 * that has a series will do.
 *
 * Such a point is approached by ever shorter steps, and crossed by one that moves the state by crossing_share of its
 * scale. So two such points are not mistaken for one. The defect in this step must be allowed by the tolerance, or be
 * explained by the rounding of time.
 */
static double crossing_step(struct Instance *instance, struct Taylor *taylor, double communication_step,
                            double length) {
  double step = crossing_share * communication_step, smallest = 2.0 * smallest_step(taylor);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    step = fmin(step, crossing_share * taylor_scale(&taylor->step, i) / fabs(taylor->step.x[i][1]));
  step = fmax(step, smallest);
  if (length >= step) return 0.0;
  step = limited(instance, taylor, step, true).step;
  for (int trial = 0; trial < 4 && step > length; trial++) {
    step = exact_interval(taylor, step);
    double size = defect_over(taylor, step);
    if (size <= 1.0) return step;
    if (step <= 2.0 * smallest) {
      use_euler_step(taylor); /* in a step this short, rounding of time hides all higher terms */
      if (isfinite(defect(&taylor->step, step))) return step;
    }
    step = fmax(0.1 * step, fmin(step, smallest));
  }
  return 0.0;
}

/*
 * Shortens the step until its defect is allowed, or explained by rounding, which no shorter step removes. Returns 0
 * below the resolution of time.
 */
static double shortened(struct Taylor *taylor, double step) {
  double power = 1.0 / (double)(taylor->saved->order + 1);
  for (;;) {
    step = exact_interval(taylor, step);
    if (step <= smallest_step(taylor)) return 0.0;
    double size = taylor->step.is_limited ? defect_over(taylor, step) : defect(&taylor->step, step);
    if (size <= 1.0) return step;
    if (isfinite(size) && size <= rounding_margin * rounding_of_right_side(&taylor->step, step)) return step;
    taylor->step.is_limited = true;
    step *= fmin(fmax(0.9 * pow(size, -power), 0.1), 0.8);
  }
}

void taylor_choose_interval(struct Instance *instance, struct Taylor *taylor, double communication_step) {
  struct TaylorSaved *saved = taylor->saved;
  const struct FmuState *fmu_state = instance->fmu_state;
  double rest =
      fmu_state->stop_time_defined ? fmu_state->stop_time - taylor->span->start : look_ahead * communication_step;
  double predicted = predicted_step(taylor), step = predicted;
  if (rest < communication_step) rest = communication_step;
  rest = fmin(rest, DBL_MAX - fabs(taylor->span->start)); /* keeps the end of the step finite */
  if (rest < step) step = rest;
  if (lagrangian.steps.max_step < step) step = lagrangian.steps.max_step;
  struct SeriesLimit limit = limited(instance, taylor, step, false);
  instance->limited_by = limit.function;
  taylor->step.is_limited = limit.step < predicted;
  double crossing = 0.0;
  if (predicted == 0.0) use_euler_step(taylor);
  if (predicted == 0.0 || limit.function != NULL)
    crossing = crossing_step(instance, taylor, communication_step, limit.step);
  taylor->crosses = crossing > 0.0;
  saved->interval = taylor->crosses ? crossing : shortened(taylor, limit.step);
  taylor->is_measured = saved->interval > 0.0;
}
