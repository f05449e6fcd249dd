/*
 * Taylor method for x' = f(t, x) (A. Jorba, M. Zou: A software package for the numerical integration of ODEs by means
 * of high-order Taylor methods, Experimental Mathematics 14, 2005).
 *
 * A step expands the solution about its start t0: x(t0 + s) = x_0 + x_1 s + ... + x_p s^p. The generated recurrences
 * give the coefficients by automatic differentiation, at a cost of O(p^2) for each product in f. The tolerance
 * determines the order p (taylor_rule.h). The coefficients and a defect check determine the step (taylor_interval.c).
 * The polynomial also is the dense output.
 *
 * A step may end after the communication point. The polynomial is evaluated there, and serves the following
 * communication steps until inputs, parameters or the state are set. The snapshot holds all that determines a step, so
 * restored simulations continue with equal bits. Compensated summation keeps the rounding error of many steps near that
 * of one.
 */
#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "methods/taylor_interval.h"
#include "support/arena.h"

static size_t taylor_saved_size(void) {
  return sizeof(struct TaylorSaved) + lagrangian.state_count * (sizeof(double) + sizeof(Series));
}

static bool taylor_is_saved_valid(const struct FmuState *fmu_state, const void *saved) {
  struct TaylorSaved first;
  memcpy(&first, saved, sizeof first);
  bool has_order = first.order >= LOWEST_ORDER && first.order <= HIGHEST_ORDER;
  bool is_new = first.order == 0 && fmu_state->changed != 0; /* no step was made yet */
  return (has_order || is_new) && first.interval >= 0.0 &&
         fmu_state->last_step.end == fmu_state->last_step.start + first.interval &&
         snapshot_is_finite((const char *)saved + sizeof first, lagrangian.state_count * (1 + SERIES_LENGTH));
}

static size_t lay_out_taylor(struct Taylor *taylor, void *block) {
  struct Arena arena = {(uintptr_t)block};
  ARENA_TAKE(&arena, taylor->input, lagrangian.input_count);
  ARENA_TAKE(&arena, taylor->work, lagrangian.taylor.rows);
  ARENA_NUMBERS(&arena, lagrangian.state_count, &taylor->step.term, &taylor->step.derivative, &taylor->step.unit);
  return arena.next - (uintptr_t)block;
}

static bool taylor_create(struct Instance *instance) {
  struct Taylor counted, *taylor = instance->memory.allocate(1, sizeof *taylor + lay_out_taylor(&counted, NULL));
  if (taylor == NULL) return solver_is_out_of_memory(instance);
  lay_out_taylor(taylor, taylor + 1);
  taylor->instance = instance;
  taylor->saved = instance->saved;
  taylor->step.low = (double *)(taylor->saved + 1);
  taylor->step.x = (Series *)(taylor->step.low + lagrangian.state_count);
  taylor->step.state = instance->work;
  taylor->step.rate = instance->work + lagrangian.state_count + lagrangian.input_count;
  taylor->span = &instance->fmu_state->last_step;
  instance->solver_memory = taylor;
  return true;
}

/*
 * Evaluates d state / dt at the origin, and the coefficients of order 1 of all series. The defect check has already
 * done so if is_measured. False if the accelerations do not exist.
 */
static bool evaluate_origin(struct Instance *instance, struct Taylor *taylor) {
  if (taylor->is_measured) return true;
  for (size_t i = 0; i < lagrangian.state_count; i++) taylor->step.state[i] = taylor->step.x[i][0];
  instance->singular = taylor_start(taylor, taylor->span->start, taylor->step.derivative);
  return instance->singular == 0;
}

/* Computes the series about the origin, whose state is in x[i][0], and its step. False if no step is possible. */
static bool expand(struct Instance *instance, struct Taylor *taylor, double communication_step) {
  double origin = taylor->span->start;
  if (!evaluate_origin(instance, taylor)) return false;
  taylor_measure_scales(&taylor->step);
  for (size_t i = 0; i < lagrangian.state_count; i++) taylor->step.x[i][1] = taylor->step.derivative[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, origin, taylor->input[i]);
  struct Point point = instance_point(instance);
  point.time = origin;
  lagrangian.taylor.series(&point, (int)taylor->saved->order, (const Series *)taylor->input, taylor->step.x,
                           taylor->work);
  instance->fmu_state->statistics[STATISTIC_DERIVATIVES]++;
  taylor_choose_interval(instance, taylor, communication_step);
  taylor->span->end = origin + taylor->saved->interval;
  return taylor->saved->interval > 0.0;
}

/* Moves the origin to the end of the step. Returns the largest change in units of the scales. */
static double move_origin(struct Taylor *taylor) {
  struct TaylorSaved *saved = taylor->saved;
  for (size_t i = 0; i < lagrangian.state_count && !taylor->is_measured; i++)
    taylor->step.term[i] = taylor_change(&taylor->step, i, saved->interval);
  double largest = taylor_move(&taylor->step);
  taylor->span->start = taylor->span->end;
  saved->interval = 0.0;
  return largest;
}

struct SeriesRule taylor_rule(const struct Instance *instance) {
  return rule_for(local_tolerance(instance->fmu_state->tolerance));
}

static void find_rule(const struct Instance *instance, struct Taylor *taylor) {
  taylor->step.tolerance = local_tolerance(instance->fmu_state->tolerance);
  if (taylor->rule.tolerance != taylor->step.tolerance) taylor->rule = taylor_rule(instance);
}

/* Projects the state at the origin onto the constraints. Returns NULL, or the reason for a failure. */
static const char *keep_constraints(struct Instance *instance, struct Taylor *taylor) {
  if (!solver_has_constraints(instance)) return NULL;
  for (size_t i = 0; i < lagrangian.state_count; i++) taylor->step.term[i] = taylor->step.x[i][0];
  const char *problem = solver_project(instance, taylor->span->start, taylor->step.term);
  for (size_t i = 0; i < lagrangian.state_count && problem == NULL; i++) taylor->step.x[i][0] = taylor->step.term[i];
  taylor->is_measured = false;
  return problem;
}

static bool taylor_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Taylor *taylor = instance->solver_memory;
  (void)step;
  taylor->saved->interval = 0.0;
  taylor->is_measured = false;
  find_rule(instance, taylor);
  taylor->step.order = taylor->saved->order = taylor->rule.order;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    taylor->step.low[i] = 0.0;
    taylor->step.x[i][0] = state[i];
  }
  return true;
}

static void taylor_resume(struct Instance *instance) {
  struct Taylor *taylor = instance->solver_memory;
  taylor->is_measured = false;
  taylor->step.order = taylor->saved->order;
  find_rule(instance, taylor);
  taylor_measure_scales(&taylor->step);
}

static bool taylor_interpolate(struct Instance *instance, double time, double *state) {
  const struct Taylor *taylor = instance->solver_memory;
  double s = time - taylor->span->start;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    state[i] = taylor->step.x[i][0] + (taylor_change(&taylor->step, i, s) + taylor->step.low[i]);
  return true;
}

/* Computes taylor_change() at three times s[3], with three independent chains of operations. */
static void three_changes(const struct TaylorStep *step, size_t i, const double *s, double *change) {
  const double *x = step->x[i], squares[] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
  int64_t j = step->order;
  Pair first = pair_at(x + j - 1), second = first, third = first;
  for (j -= 2; j > 1; j -= 2) {
    Pair next = pair_at(x + j - 1);
    first = pair_sum(pair_multiple(first, squares[0]), next);
    second = pair_sum(pair_multiple(second, squares[1]), next);
    third = pair_sum(pair_multiple(third, squares[2]), next);
  }
  change[0] = taylor_end_of_change(x, j, first, s[0]);
  change[1] = taylor_end_of_change(x, j, second, s[1]);
  change[2] = taylor_end_of_change(x, j, third, s[2]);
}

static bool taylor_interpolate_at(struct Instance *instance, const double *times, size_t count, double *states) {
  const struct Taylor *taylor = instance->solver_memory;
  size_t n = lagrangian.state_count, k = 0;
  for (; k + 3 <= count; k += 3) {
    const double s[] = {times[k] - taylor->span->start, times[k + 1] - taylor->span->start,
                        times[k + 2] - taylor->span->start};
    for (size_t i = 0; i < n; i++) {
      double change[3];
      three_changes(&taylor->step, i, s, change);
      for (size_t j = 0; j < 3; j++) states[(k + j) * n + i] = taylor->step.x[i][0] + (change[j] + taylor->step.low[i]);
    }
  }
  for (; k < count; k++) taylor_interpolate(instance, times[k], states + k * n);
  return true;
}

static bool stagnates(struct Stagnation *stagnation, double moved, double tolerance) {
  stagnation->path += moved;
  if (++stagnation->steps < STAGNATION_STEPS) return false;
  bool stays = stagnation->path < STAGNATION_STEPS * tolerance;
  *stagnation = (struct Stagnation){0};
  return stays;
}

/*
 * Returns the reason for giving up if the steps stagnate; NULL if they do not. moved: the change in the last step in
 * units of the scales.
 *
 * In stiff systems, many steps hardly move the state, because the stability of fast modes limits them. In a system with
 * friction that sticks but is written as a jump, one crossing follows the other.
 */
static const char *reason_to_stop(const struct Instance *instance, struct Taylor *taylor, double moved) {
  if (!taylor->crosses) taylor->crossing.path += moved;
  else if (stagnates(&taylor->crossing, moved, 1e-9))
    return "a function chatters, as does dry friction that is not written as <friction>";
  if (!taylor->step.is_limited && stagnates(&taylor->regular, moved, fmin(instance->fmu_state->tolerance, 1e-6)))
    return "the system is stiff and needs <solver method=\"auto\"/>";
  return NULL;
}

/* Drops the series: the state stays that of the origin. */
static void cut_series(struct Taylor *taylor) {
  taylor->saved->interval = 0.0;
  taylor->span->end = taylor->span->start;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    for (int k = 1; k < SERIES_LENGTH; k++) taylor->step.x[i][k] = 0.0;
}

static const char *taylor_advance(struct Instance *instance, const struct CommunicationStep *step) {
  struct Taylor *taylor = instance->solver_memory;
  if (step->count == 0) taylor->regular = taylor->crossing = (struct Stagnation){0};
  /* A series that an event has cut off says nothing about stagnation. */
  const char *problem = taylor->saved->interval > 0.0 ? reason_to_stop(instance, taylor, move_origin(taylor)) : NULL;
  if (problem == NULL) problem = keep_constraints(instance, taylor);
  if (problem == NULL && !expand(instance, taylor, step->length))
    problem = "the motion has a singularity or grows without bound";
  if (problem != NULL) cut_series(taylor);
  else instance->fmu_state->statistics[STATISTIC_STEPS]++;
  return problem;
}

const struct Solver solver_taylor = {.name = "the Taylor series",
                                     .alternatives = "auto where rates differ much",
                                     .saved_size = taylor_saved_size,
                                     .is_saved_valid = taylor_is_saved_valid,
                                     .create = taylor_create,
                                     .destroy = solver_free_memory,
                                     .restart = taylor_restart,
                                     .resume = taylor_resume,
                                     .advance = taylor_advance,
                                     .interpolate = taylor_interpolate,
                                     .interpolate_at = taylor_interpolate_at};
