#include "lane_steps.h"

#include <float.h>
#include <stdlib.h>

#include "methods/taylor_rule.h"

_Thread_local Mask failed_lanes;

/* the method that switches to another if the system is stiff (single/single_run.c) */
extern const struct Solver solver_auto;

/* --- Memory ------------------------------------------------------------------------------------------------------- */

Lanes *lane_rows(size_t count, void **memory) {
  size_t size = (count + 1) * sizeof(Lanes);
  char *block = malloc(size);
  *memory = block;
  if (block == NULL) return NULL;
  memset(block, 0, size);
  return (void *)(block + (sizeof(Lanes) - (uintptr_t)block % sizeof(Lanes)));
}

/* Returns the next count rows of a block. */
static Lanes *take(Lanes **block, size_t count) {
  Lanes *rows = *block;
  *block += count;
  return rows;
}

static Series *take_series(Lanes **block, size_t count) {
  return (Series *)take(block, count * SERIES_LENGTH);
}

bool lane_steps_create(struct LaneSteps *steps, double tolerance, double length) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count;
  size_t series = states + inputs + lagrangian.taylor.rows;
  size_t rows = series * SERIES_LENGTH + lagrangian.parameter_count + lagrangian.parameter_constants_count +
                lagrangian.work_count + lagrangian.following_count + inputs + 6 * states;
  void *memory;
  Lanes *block = lane_rows(rows, &memory);
  if (block == NULL) return false;
  struct SeriesRule rule = rule_for(local_tolerance(tolerance));
  *steps = (struct LaneSteps){
      .memory = memory, .order = (int)rule.order, .margin = rule.margin, .tolerance = tolerance, .length = length};
  steps->longest = fmin(look_ahead * length, lagrangian.steps.max_step);
  steps->x = take_series(&block, states);
  steps->input = take_series(&block, inputs);
  steps->work = take_series(&block, lagrangian.taylor.rows);
  steps->parameter = take(&block, lagrangian.parameter_count);
  steps->parameter_constants = take(&block, lagrangian.parameter_constants_count);
  steps->constants = take(&block, inputs);
  steps->low = take(&block, states);
  steps->unit = take(&block, states);
  steps->start = take(&block, lagrangian.following_count);
  steps->derivative = take(&block, states);
  steps->change = take(&block, states);
  steps->state = take(&block, states);
  steps->rate = take(&block, states);
  steps->point_work = take(&block, lagrangian.work_count);
  return true;
}

void lane_steps_destroy(struct LaneSteps *steps) {
  free(steps->memory);
}

/* --- The polynomials, as in methods/taylor.h and taylor_interval.c ----------------------------------------------------- */

static void measure_scales(struct LaneSteps *steps) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    steps->unit[i] = 1.0 / lanes_larger(lanes_absolute(steps->x[i][0]), LANES_OF(lagrangian.steps.nominal[i]));
}

/* Returns the change of state variable i from the origin to s after it; Horner's rule in s^2, twice. */
static Lanes change(const struct LaneSteps *steps, size_t i, Lanes s) {
  const Lanes *x = steps->x[i], square = s * s;
  int j = steps->order;
  Lanes first = x[j], second = x[j - 1];
  for (j -= 2; j > 1; j -= 2) {
    first = first * square + x[j];
    second = second * square + x[j - 1];
  }
  return j == 1 ? ((first * s + second) * s + x[1]) * s : (first * s + second) * s;
}

/* Does the same, with the time derivative at s. */
static Lanes change_and_rate(const struct LaneSteps *steps, size_t i, Lanes s, Lanes *rate) {
  const Lanes *x = steps->x[i], square = s * s;
  int j = steps->order;
  double factor = j;
  Lanes first = x[j], second = x[j - 1];
  Lanes first_rate = factor * first, second_rate = (factor - 1.0) * second;
  for (j -= 2; j > 1; j -= 2) {
    factor -= 2.0;
    first = first * square + x[j];
    second = second * square + x[j - 1];
    first_rate = first_rate * square + factor * x[j];
    second_rate = second_rate * square + (factor - 1.0) * x[j - 1];
  }
  *rate = j == 1 ? (first_rate * s + second_rate) * s + x[1] : first_rate * s + second_rate;
  return j == 1 ? ((first * s + second) * s + x[1]) * s : (first * s + second) * s;
}

void lane_steps_take_state(struct LaneSteps *steps, Lanes time) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    steps->state[i] = steps->x[i][0] + (change(steps, i, time - steps->origin) + steps->low[i]);
}

/*
 * --- Prediction of the step
 * ------------------------------------------------------------------------------------------
 */

/* Returns the largest coefficient of an order, in units of the scales. */
static Lanes norm(const struct LaneSteps *steps, int order) {
  Lanes largest = {0};
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    Lanes size = lanes_absolute(steps->x[i][order]) * steps->unit[i];
    largest = lanes_select(size <= largest, largest, size); /* a NaN is kept */
  }
  return largest;
}

/* Adding it to a whole number below 2^51 puts that into the low bits of the sum. */
static const double whole_numbers = 0x1.8p52;

/* Returns the base-2 logarithm of a nonnegative number with an error below 0.01. */
static Lanes rough_logarithm(Lanes x) {
  Bits bits = (Bits)x, exponent = (bits >> 52) + (Bits)LANES_OF(whole_numbers);
  Lanes mantissa = (Lanes)((bits & 0xfffffffffffffu) | (uint64_t)1023 << 52); /* from 1 to 2 */
  return ((Lanes)exponent - whole_numbers) - 1022.0 + (0.5 * mantissa - 1.0) * (2.65 - 0.66 * mantissa);
}

/* Returns 2^x to 1 %, for |x| < 1000. */
static Lanes rough_power_of_two(Lanes x) {
  Lanes sum = x + whole_numbers, rest = x - (sum - whole_numbers);
  Lanes power = (Lanes)(((Bits)sum + 1023) << 52);
  return power * (1.0 + rest * (0.693 + rest * (0.24 + rest * 0.055)));
}

/*
 * Returns the predicted step, from the last two coefficients that do not both vanish; see taylor_interval.c. 0 if they
 * are not finite.
 */
static Lanes predicted_step(const struct LaneSteps *steps) {
  Lanes last = norm(steps, steps->order), before = norm(steps, steps->order - 1);
  Lanes share = LANES_OF(1.0 / steps->order), share_before = LANES_OF(1.0 / (steps->order - 1));
  Mask vanish = last + before == 0.0;
  for (int order = steps->order - 1; any_lane(vanish) && order > steps->order / 2; order--) {
    last = lanes_select(vanish, before, last);
    before = lanes_select(vanish, norm(steps, order - 1), before);
    share = lanes_select(vanish, LANES_OF(1.0 / order), share);
    share_before = lanes_select(vanish, LANES_OF(1.0 / (order - 1)), share_before);
    vanish &= last + before == 0.0;
  }
  Lanes of_last = rough_logarithm(last) * share, of_before = rough_logarithm(before) * share_before;
  Lanes exponent = -lanes_larger(of_last, of_before) - steps->margin;
  Lanes step = rough_power_of_two(lanes_larger(lanes_smaller(exponent, LANES_OF(900.0)), LANES_OF(-900.0)));
  step = lanes_select(vanish, LANES_OF(DBL_MAX), step);
  return lanes_select(lanes_are_finite(last + before), step, (Lanes){0});
}

/* --- The defect ---------------------------------------------------------------------------------------------------- */

struct Point lane_steps_point(const struct LaneSteps *steps, Lanes time) {
  return (struct Point){.time = time,
                        .state = steps->state,
                        .input = steps->constants,
                        .parameter = steps->parameter,
                        .parameter_constants = steps->parameter_constants,
                        .work = steps->point_work};
}

/*
 * Evaluates the right side of the equations at s after the origin, at the state x_0 + steps->change. share: relative
 * perturbation of the state variables, with alternating signs. Returns the lanes in which it does not exist.
 */
static Mask right_side(struct LaneSteps *steps, Lanes s, double share, Lanes *derivative) {
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    steps->state[i] = steps->x[i][0] + (steps->change[i] + steps->low[i]);
    if (share != 0.0) steps->state[i] *= 1.0 + (i % 2 == 0 ? share : -share);
  }
  struct Point point = lane_steps_point(steps, steps->origin + s);
  failed_lanes = (Mask){0};
  lagrangian.taylor.start(&point, derivative, steps->work);
  return failed_lanes;
}

/* Returns the allowed defect times the step, in units of the scales. */
static Lanes allowed_defect(const struct LaneSteps *steps) {
  double size = local_tolerance(steps->tolerance);
  return lanes_select(steps->is_limited, LANES_OF(size), LANES_OF(defect_margin * (steps->order + 1) * size));
}

/* Returns the larger one; INFINITY if size is NaN. */
static Lanes larger_or_infinite(Lanes largest, Lanes size) {
  return lanes_select(size <= largest, largest, lanes_select(size < INFINITY, size, LANES_OF(INFINITY)));
}

/* Returns the largest defect at s, times s, in units of the scales and of the allowed one. */
static Lanes defect(struct LaneSteps *steps, Lanes s) {
  size_t first = lagrangian.coordinate_count, states = lagrangian.state_count;
  Lanes largest = {0};
  for (size_t i = 0; i < first; i++) steps->change[i] = change(steps, i, s);
  for (size_t i = first; i < states; i++) steps->change[i] = change_and_rate(steps, i, s, &steps->rate[i]);
  Mask failed = right_side(steps, s, 0.0, steps->derivative);
  for (size_t i = first; i < states; i++) {
    Lanes exact = steps->derivative[i];
    Lanes difference = lanes_absolute(exact - steps->rate[i]) - rounding * DBL_EPSILON * lanes_absolute(exact);
    largest = larger_or_infinite(largest, difference * s * steps->unit[i]);
  }
  return lanes_select(failed, LANES_OF(INFINITY), largest / allowed_defect(steps));
}

/* Does the same; if the coefficients do not limit the step, also inside it. */
static Lanes defect_over(struct LaneSteps *steps, Lanes s) {
  Lanes inside = {0};
  for (int i = 0; any_lane(steps->is_limited) && i < DEFECT_POINTS; i++)
    inside = larger_or_infinite(inside, defect(steps, defect_points[i] * s));
  Lanes end = defect(steps, s);
  return lanes_select(steps->is_limited, larger_or_infinite(end, inside), end);
}

/* Returns the effect of rounding the state at s on the right side, in units of defect(), which came before. */
static Lanes rounding_of_right_side(struct LaneSteps *steps, Lanes s) {
  Lanes largest = {0};
  Mask failed = right_side(steps, s, 4.0 * DBL_EPSILON, steps->rate);
  failed |= right_side(steps, s, 0.0, steps->derivative);
  for (size_t i = lagrangian.coordinate_count; i < lagrangian.state_count; i++) {
    Lanes moved = lanes_absolute(steps->rate[i] - steps->derivative[i]) * s * steps->unit[i];
    largest = lanes_larger(moved, largest);
  }
  return lanes_select(failed, (Lanes){0}, largest / allowed_defect(steps));
}

/* --- The step ------------------------------------------------------------------------------------------------------ */

/* Rounds the step so that the next origin is exact, and time does not drift. */
static Lanes exact_interval(const struct LaneSteps *steps, Lanes step) {
  return steps->origin + step - steps->origin;
}

/* True for steps below the resolution of time. */
static Mask is_too_short(const struct LaneSteps *steps, Lanes step) {
  return step <= 8.0 * DBL_EPSILON * lanes_absolute(steps->origin);
}

/* Returns the factor that shortens a step with this defect. */
static double shortening(double size, int order) {
  return fmin(fmax(0.9 * pow(size, -1.0 / (order + 1)), 0.1), 0.8);
}

/*
 * Shortens steps until their defects are accepted, and returns the lanes in which that fails. A defect within the
 * rounding error is accepted, as shorter steps do not reduce it. Ends, as each round shortens a step by a factor of at
 * most 0.8, down to the resolution of time.
 */
static Mask shorten(struct LaneSteps *steps, Lanes step, Mask active) {
  Mask lost = active & ~(step > 0.0);
  for (;;) {
    lost |= active & is_too_short(steps, step);
    step = exact_interval(steps, lanes_select(active & ~lost, step, (Lanes){0}));
    Lanes size = defect_over(steps, step);
    Mask is_large = active & ~lost & ~(size <= 1.0);
    if (any_lane(is_large)) {
      Lanes explained = rounding_margin * rounding_of_right_side(steps, step);
      is_large &= ~((size < INFINITY) & (size <= explained));
    }
    if (!any_lane(is_large)) break;
    steps->is_limited |= is_large;
    for (int i = 0; i < LANES; i++)
      if (is_large[i]) step[i] *= shortening(size[i], steps->order);
  }
  steps->interval = step;
  return lost;
}

/* Returns lanes so close to a singular point that a step across it may be shorter; the FMU handles them. */
static Mask approaches(const struct LaneSteps *steps, const struct SeriesLimit *limit) {
  Lanes crossing = LANES_OF(crossing_share * steps->length);
  if (!any_lane(limit->shortened)) return (Mask){0};
  for (size_t i = 0; i < lagrangian.state_count; i++)
    crossing = lanes_smaller(crossing, crossing_share / (steps->unit[i] * lanes_absolute(steps->x[i][1])));
  return limit->shortened & ((limit->step < crossing) | is_too_short(steps, 0.5 * limit->step));
}

/*
 * Returns lanes in which so many consecutive steps may be limited by fast modes that the FMU would try another method;
 * see methods/stiffness.c.
 */
static Mask may_be_stiff(struct LaneSteps *steps) {
  /* consecutive steps; two windows of auto.c */
  enum { FAST_STEPS = 12 };
  if (lagrangian.solver != &solver_auto) return (Mask){0};
  Lanes last = norm(steps, steps->order) * steps->interval * steps->interval, before = norm(steps, steps->order - 2);
  Mask is_fast = (FALL_OF_FAST * FALL_OF_FAST * last > before) & ~steps->is_limited;
  steps->fast = lanes_select(is_fast, steps->fast + 1.0, (Lanes){0});
  return steps->fast >= (double)FAST_STEPS;
}

Mask lane_steps_expand(struct LaneSteps *steps, Mask active) {
  measure_scales(steps);
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->x[i][1] = steps->derivative[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) steps->input[i][0] = steps->constants[i];
  struct Point point = lane_steps_point(steps, steps->origin);
  lagrangian.taylor.series(&point, steps->order, (const Series *)steps->input, steps->x, steps->work);
  Lanes predicted = predicted_step(steps);
  struct SeriesLimit limit = {.order = steps->order - 1, .step = lanes_smaller(predicted, LANES_OF(steps->longest))};
  limit.step = lanes_select(active, limit.step, (Lanes){0});
  if (lagrangian.taylor.limit != NULL)
    lagrangian.taylor.limit(&point, (const Series *)steps->input, (const Series *)steps->x, (const Series *)steps->work,
                            &limit);
  steps->is_limited = active & (limit.step < predicted);
  Mask left = active & approaches(steps, &limit);
  left |= shorten(steps, limit.step, active & ~left);
  return left | (active & may_be_stiff(steps));
}

/* Returns the stagnating lanes: stiff ones, in which many steps of the predicted length hardly move the state. */
static Mask stagnates(struct LaneSteps *steps, Lanes moved) {
  steps->path += lanes_select(steps->is_limited, (Lanes){0}, moved);
  steps->steps += lanes_select(steps->is_limited, (Lanes){0}, LANES_OF(1.0));
  Mask many = steps->steps >= (double)STAGNATION_STEPS;
  if (!any_lane(many)) return many;
  Mask stays = many & (steps->path < STAGNATION_STEPS * fmin(steps->tolerance, 1e-6));
  steps->path = lanes_select(many, (Lanes){0}, steps->path);
  steps->steps = lanes_select(many, (Lanes){0}, steps->steps);
  return stays;
}

Mask lane_steps_move(struct LaneSteps *steps) {
  Lanes largest = {0};
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    Lanes before = steps->x[i][0], term = steps->change[i] + steps->low[i];
    Lanes sum = before + term, part = sum - before;
    largest = lanes_larger(lanes_absolute(term) * steps->unit[i], largest);
    steps->low[i] = (before - (sum - part)) + (term - part);
    steps->x[i][0] = sum;
  }
  steps->origin += steps->interval;
  return stagnates(steps, largest);
}

Mask lane_steps_start(struct LaneSteps *steps) {
  failed_lanes = (Mask){0};
  lagrangian.prepare(steps->parameter, steps->parameter_constants);
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->state[i] = steps->x[i][0];
  struct Point point = lane_steps_point(steps, steps->origin);
  lagrangian.taylor.start(&point, steps->derivative, steps->work);
  return failed_lanes;
}
