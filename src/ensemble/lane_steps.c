#include "lane_steps.h"

#include <float.h>
#include <stdlib.h>

#include "methods/taylor_defect.h"
#include "support/arena.h"

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

static size_t lay_out_rows(struct LaneSteps *steps, Lanes *block) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_TAKE(&arena, steps->step.x, states);
  ARENA_TAKE(&arena, steps->input, inputs);
  ARENA_TAKE(&arena, steps->work, lagrangian.taylor.rows);
  ARENA_NUMBERS(&arena, lagrangian.parameter_count, &steps->parameter);
  ARENA_NUMBERS(&arena, lagrangian.parameter_constants_count, &steps->parameter_constants);
  ARENA_NUMBERS(&arena, inputs, &steps->constants);
  ARENA_NUMBERS(&arena, lagrangian.following_count, &steps->start);
  ARENA_NUMBERS(&arena, states, &steps->step.low, &steps->step.unit, &steps->step.derivative, &steps->step.term,
                &steps->step.state, &steps->step.rate);
  ARENA_NUMBERS(&arena, lagrangian.work_count, &steps->point_work);
  return (arena.next - (uintptr_t)block) / sizeof(Lanes);
}

bool lane_steps_create(struct LaneSteps *steps, double tolerance, double length) {
  void *memory;
  Lanes *block = lane_rows(lay_out_rows(steps, NULL), &memory);
  if (block == NULL) return false;
  struct SeriesRule rule = rule_for(local_tolerance(tolerance));
  *steps = (struct LaneSteps){.memory = memory,
                              .step = {.order = rule.order, .tolerance = rule.tolerance},
                              .margin = rule.margin,
                              .tolerance = tolerance,
                              .length = length};
  steps->longest = fmin(look_ahead * length, lagrangian.steps.max_step);
  lay_out_rows(steps, block);
  return true;
}

void lane_steps_destroy(struct LaneSteps *steps) {
  free(steps->memory);
}

void lane_steps_take_state(struct LaneSteps *steps, Lanes time) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    steps->step.state[i] =
        steps->step.x[i][0] + (taylor_change(&steps->step, i, time - steps->origin) + steps->step.low[i]);
}

/*
 * --- Prediction of the step
 * ------------------------------------------------------------------------------------------
 */

/* Returns the largest coefficient of an order, in units of the scales. */
static Lanes norm(const struct LaneSteps *steps, int order) {
  Lanes largest = {0};
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    Lanes size = lanes_absolute(steps->step.x[i][order]) * steps->step.unit[i];
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
  int highest = (int)steps->step.order;
  Lanes last = norm(steps, highest), before = norm(steps, highest - 1);
  Lanes share = LANES_OF(1.0 / highest), share_before = LANES_OF(1.0 / (highest - 1));
  Mask vanish = last + before == 0.0;
  for (int order = highest - 1; any_lane(vanish) && order > highest / 2; order--) {
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
                        .state = steps->step.state,
                        .input = steps->constants,
                        .parameter = steps->parameter,
                        .parameter_constants = steps->parameter_constants,
                        .work = steps->point_work};
}

static Mask evaluate_derivative(const struct TaylorStep *step, Lanes s, Lanes *derivative) {
  const struct LaneSteps *steps = (const struct LaneSteps *)step;
  struct Point point = lane_steps_point(steps, steps->origin + s);
  failed_lanes = (Mask){0};
  lagrangian.taylor.start(&point, derivative, steps->work);
  return ~failed_lanes;
}

/* Returns the largest defect at the end; if the coefficients do not limit the step, also inside it. */
static Lanes defect_over(struct LaneSteps *steps, Lanes s) {
  Lanes inside = {0};
  for (int i = 0; any_lane(steps->step.is_limited) && i < DEFECT_POINTS; i++)
    inside = larger_or_infinite(inside, defect(&steps->step, defect_points[i] * s));
  Lanes end = defect(&steps->step, s);
  return lanes_select(steps->step.is_limited, larger_or_infinite(end, inside), end);
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
static double shortening(double size, int64_t order) {
  return fmin(fmax(0.9 * pow(size, -1.0 / (double)(order + 1)), 0.1), 0.8);
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
      Lanes explained = rounding_margin * rounding_of_right_side(&steps->step, step);
      is_large &= ~((size < INFINITY) & (size <= explained));
    }
    if (!any_lane(is_large)) break;
    steps->step.is_limited |= is_large;
    for (int i = 0; i < LANES; i++)
      if (is_large[i]) step[i] *= shortening(size[i], steps->step.order);
  }
  steps->interval = step;
  return lost;
}

/* Returns lanes so close to a singular point that a step across it may be shorter; the FMU handles them. */
static Mask approaches(const struct LaneSteps *steps, const struct SeriesLimit *limit) {
  Lanes crossing = LANES_OF(crossing_share * steps->length);
  if (!any_lane(limit->shortened)) return (Mask){0};
  for (size_t i = 0; i < lagrangian.state_count; i++)
    crossing = lanes_smaller(crossing, crossing_share / (steps->step.unit[i] * lanes_absolute(steps->step.x[i][1])));
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
  int order = (int)steps->step.order;
  Lanes last = norm(steps, order) * steps->interval * steps->interval, before = norm(steps, order - 2);
  Mask is_fast = (FALL_OF_FAST * FALL_OF_FAST * last > before) & ~steps->step.is_limited;
  steps->fast = lanes_select(is_fast, steps->fast + 1.0, (Lanes){0});
  return steps->fast >= (double)FAST_STEPS;
}

Mask lane_steps_expand(struct LaneSteps *steps, Mask active) {
  int order = (int)steps->step.order;
  taylor_measure_scales(&steps->step);
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->step.x[i][1] = steps->step.derivative[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) steps->input[i][0] = steps->constants[i];
  struct Point point = lane_steps_point(steps, steps->origin);
  lagrangian.taylor.series(&point, order, (const Series *)steps->input, steps->step.x, steps->work);
  Lanes predicted = predicted_step(steps);
  struct SeriesLimit limit = {.order = order - 1, .step = lanes_smaller(predicted, LANES_OF(steps->longest))};
  limit.step = lanes_select(active, limit.step, (Lanes){0});
  if (lagrangian.taylor.limit != NULL)
    lagrangian.taylor.limit(&point, (const Series *)steps->input, (const Series *)steps->step.x,
                            (const Series *)steps->work, &limit);
  steps->step.is_limited = active & (limit.step < predicted);
  Mask left = active & approaches(steps, &limit);
  left |= shorten(steps, limit.step, active & ~left);
  return left | (active & may_be_stiff(steps));
}

/* Returns the stagnating lanes: stiff ones, in which many steps of the predicted length hardly move the state. */
static Mask stagnates(struct LaneSteps *steps, Lanes moved) {
  steps->path += lanes_select(steps->step.is_limited, (Lanes){0}, moved);
  steps->steps += lanes_select(steps->step.is_limited, (Lanes){0}, LANES_OF(1.0));
  Mask many = steps->steps >= (double)STAGNATION_STEPS;
  if (!any_lane(many)) return many;
  Mask stays = many & (steps->path < STAGNATION_STEPS * fmin(steps->tolerance, 1e-6));
  steps->path = lanes_select(many, (Lanes){0}, steps->path);
  steps->steps = lanes_select(many, (Lanes){0}, steps->steps);
  return stays;
}

Mask lane_steps_move(struct LaneSteps *steps) {
  Lanes moved = taylor_move(&steps->step);
  steps->origin += steps->interval;
  return stagnates(steps, moved);
}

Mask lane_steps_start(struct LaneSteps *steps) {
  failed_lanes = (Mask){0};
  lagrangian.prepare(steps->parameter, steps->parameter_constants);
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->step.state[i] = steps->step.x[i][0];
  struct Point point = lane_steps_point(steps, steps->origin);
  lagrangian.taylor.start(&point, steps->step.derivative, steps->work);
  return failed_lanes;
}
