#include "events/exchange.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "detection/indicators.h"
#include "nonsmooth/resolve.h"
#include "nonsmooth/resolution.h"
#include "instance/active_constraints.h"
#include "instance/projection.h"

/* Steps of Newton's method to a zero. */
enum { APPROACH_LIMIT = 20 };

/* Expressions of events that an importer may pass in one step. */
enum { LATE_LIMIT = 8 };

/* Sets each branch to the piece that its indicator calls for at a point. True if a piece changed. */
static bool set_pieces(struct Resolution *resolution, const struct Point *point) {
  const struct SwitchTable *switches = resolution->switches;
  double *indicator = resolution->rounding;
  bool changes = false;
  if (!indicators_at(resolution->instance, point->time, point->state, indicator)) return false;
  for (size_t i = 0; i < switches->branch_count; i++) {
    const struct BranchMetadata *branch = &switches->branches[i];
    double sign = indicator[i] > 0.0 ? 1.0 : -1.0;
    bool has_sign = fabs(indicator[i]) > 0.0 && !branch->is_last_sign;
    if (!has_sign || sign == mode_of(resolution, branch->mode)) continue;
    resolution_set_mode(resolution, branch->mode, sign);
    changes = true;
  }
  return changes && evaluate_prepare(resolution->instance) == STATUS_DONE;
}

/* An indicator may exist only after other pieces have changed, hence the rounds. */
bool exchange_change_pieces(struct Instance *instance, const struct Point *point) {
  struct Resolution resolution = resolution_of(instance);
  bool changes = false;
  resolution_keep_modes(&resolution);
  for (size_t round = 0; round < resolution.switches->branch_count && set_pieces(&resolution, point); round++)
    changes = true;
  return changes;
}

void exchange_return_pieces(struct Instance *instance) {
  struct Resolution resolution = resolution_of(instance);
  resolution_restore_modes(&resolution);
  evaluate_prepare(instance);
}

/* Gives indicators without a value beyond the end of a piece their values by the piece there. */
static void complete_indicators(struct Instance *instance, double *value) {
  size_t count = indicator_count(lagrangian.switches);
  double *completed = instance->switching_work + count; /* values may be stored before it */
  struct Point point = instance_point(instance);
  bool has_gaps = false;
  for (size_t i = 0; i < count; i++) has_gaps |= isnan(value[i]);
  if (!has_gaps || !exchange_change_pieces(instance, &point)) return;
  bool are_known = indicators_at(instance, point.time, point.state, completed);
  exchange_return_pieces(instance);
  for (size_t i = 0; i < count && are_known; i++)
    if (isnan(value[i])) value[i] = completed[i];
}

/* Distance beyond 0 at which a zero is reported: the largest one, and in units of the rounding error bound. */
static const double largest_shift = 1e-11, shift_in_error_bound = 1e5;

/*
 * Returns the shift, from the rounding error bounds by the state (error_bound) and by the indicator's operations
 * (rounding).
 */
static double shift_of(double error_bound, double rounding) {
  double shift = fmax(shift_in_error_bound * error_bound, FLOOR_IN_ERROR_BOUND * rounding);
  return shift > 0.0 && shift < largest_shift ? shift : largest_shift;
}

/* Computes shift[i] of each indicator; workspace follows. Small indicators, such as gaps in large units, get less. */
static void find_shifts(struct Instance *instance, const double *value, double *shift) {
  size_t count = indicator_count(lagrangian.switches);
  double *rounding = shift + count, *rounded = rounding + count;
  double time = instance->fmu_state->time;
  indicator_rounding_bounds(instance, time, instance->state, instance->acceleration, rounding);
  bool known = indicator_error_bound(instance, time, instance->state, true, value, rounded, shift);
  for (size_t i = 0; i < count; i++)
    shift[i] = known && !indicator_is_force(instance, i) ? shift_of(shift[i], rounding[i]) : largest_shift;
}

/* Gaps below this, in m or rad, may be errors of an importer's integrator. */
static const double least_gap = 1e-6;

/* In s: a gap that parts is reported with the way at its rate in this time. */
static const double parting_time = 1.0;

/* True if a contact is open, and its gap may be an error. */
static bool may_part(const struct Instance *instance, const double *indicator, size_t contact) {
  return !contact_holds(instance, contact) && indicator[contact_indicator(lagrangian.switches, contact)] < least_gap;
}

/*
 * Adds to small gaps that part, with a growing rate, the way at their rate. A contact that its force has opened parts
 * with the third power of the time: errors of an importer's integrator would close it again and again. values:
 * workspace.
 */
static void let_part(struct Instance *instance, const struct Point *point, double *indicator, double *values) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool any_parts = false;
  for (size_t i = 0; i < switches->contact_count; i++) any_parts |= may_part(instance, indicator, i);
  if (!any_parts || lagrangian.constraints.accelerations(point, instance->acceleration) != 0) return;
  switches->switching_values(point, instance->acceleration, values);
  for (size_t i = 0; i < switches->contact_count; i++) {
    const double *value = values + contact_slot(switches, i, 0);
    bool parts = value[CONTACT_RATE] > 0.0 && value[CONTACT_ACCELERATION] > 0.0;
    if (may_part(instance, indicator, i) && parts)
      indicator[contact_indicator(switches, i)] += parting_time * value[CONTACT_RATE];
  }
}

/*
 * A reported indicator keeps its sign until it is a little beyond 0, so that it is not 0 after an event (FMI 2.0,
 * section 3.2.2; FMI 3.0, section 3.2.1). The indicator of a branch at rest at 0 changes its sign when it leaves 0 to
 * either side.
 */
bool exchange_indicators(struct Instance *instance, double *value) {
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = evaluate_point(instance);
  if (!indicators_at(instance, point.time, point.state, value)) return false;
  size_t count = indicator_count(lagrangian.switches);
  double *shift = instance->switching_work + count; /* values may be stored before it */
  complete_indicators(instance, value);
  find_shifts(instance, value, shift);
  let_part(instance, &point, value, shift + 2 * count + lagrangian.state_count);
  for (size_t i = 0; i < count; i++) {
    double sign = indicator_sign(instance, i);
    value[i] = sign == 0.0 ? shift[i] - fabs(value[i]) : value[i] + sign * shift[i];
  }
  return true;
}

bool exchange_is_due(struct Instance *instance) {
  double *value = instance->switching_work;
  if (!exchange_indicators(instance, value)) return false;
  bool due = false;
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++)
    due |= (indicator_sign(instance, i) < 0.0 ? -value[i] : value[i]) < 0.0;
  return due;
}

/*
 * Events that wait for crossings in both directions. An importer is beyond the zero of the expression when it asks.
 * If the event turned the motion back there, it would cross the zero again. So the state goes back to the zero by
 * its Taylor polynomial of second order. It passes the event as in co-simulation, and goes forward by the same
 * time. The errors are of third order in this time.
 */

/* True if an event waits for both directions, and the importer has integrated to the present state. */
static bool may_return(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool looks_both_ways = false;
  for (size_t i = 0; i < switches->event_count; i++) looks_both_ways |= switches->events[i].passage == PASSAGE_BOTH;
  return looks_both_ways && switches->has_last_signs && instance->fmu_state->changed != CHANGED_VALUES;
}

/* Returns the time in s since an expression crossed 0; 0 if it has not. */
static double lateness_of(const struct Resolution *resolution, size_t branch) {
  const struct BranchMetadata *metadata = &resolution->switches->branches[branch];
  double last_sign = mode_of(resolution, metadata->mode), value = resolution->value[branch];
  double rate = resolution->value[branch_rate_slot(resolution->switches, branch)];
  return metadata->is_last_sign && last_sign * value < 0.0 && last_sign * rate < 0.0 ? value / rate : 0.0;
}

/* Returns the expression that crossed first; branch_count for none. */
static size_t find_late_branch(const struct Resolution *resolution) {
  size_t passed = resolution->switches->branch_count;
  double longest = 0.0;
  for (size_t i = 0; i < resolution->switches->branch_count; i++) {
    double lateness = lateness_of(resolution, i);
    if (!(lateness > longest)) continue;
    longest = lateness;
    passed = i;
  }
  return passed;
}

/* Moves the state by a time in s, with the accelerations of the last evaluation. */
static void move_by(struct Resolution *resolution, double duration) {
  const double *acceleration = resolution_accelerations(resolution);
  double *position = resolution->state, *velocity = position + lagrangian.coordinate_count;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    position[i] += duration * (velocity[i] + 0.5 * duration * acceleration[i]);
    velocity[i] += duration * acceleration[i];
  }
  resolution->time += duration;
}

/* Moves the state back to the zero of a branch by Newton's method. False if it does not converge. */
static bool go_to_zero(struct Resolution *resolution, size_t branch) {
  for (int i = 0; i < APPROACH_LIMIT; i++) {
    double rate = resolution->value[branch_rate_slot(resolution->switches, branch)];
    double duration = -resolution->value[branch] / rate;
    if (!isfinite(duration)) return false;
    if (fabs(duration) <= 4.0 * DBL_EPSILON * fabs(resolution->time) || resolution->value[branch] == 0.0) return true;
    move_by(resolution, duration);
    if (!resolution_values(resolution, resolution->state, resolution->value)) return false;
  }
  return false;
}

/* Handles the event at the first zero that was crossed, *passes if there was one. Returns NULL, or a reason to stop. */
static const char *pass_late(struct Instance *instance, bool *passes) {
  double time = instance->fmu_state->time, *state = instance->event_state, *before = state + lagrangian.state_count;
  size_t size = lagrangian.state_count * sizeof *state;
  *passes = false;
  memcpy(state, instance->state, size);
  struct Resolution resolution = resolution_at(instance, time, state, IN_EXCHANGE);
  if (evaluate_prepare(instance) != STATUS_DONE || !resolution_values(&resolution, state, resolution.value))
    return NULL;
  size_t branch = find_late_branch(&resolution);
  if (branch == lagrangian.switches->branch_count || !go_to_zero(&resolution, branch)) return NULL;
  double zero = resolution.time;
  memcpy(before, state, size);
  const char *problem = resolve(instance, zero, state, AT_EVENT, branch, passes);
  if (problem != NULL || memcmp(before, state, size) == 0) return problem;
  resolution = resolution_at(instance, zero, state, IN_EXCHANGE);
  if (evaluate_prepare(instance) != STATUS_DONE || !resolution_values(&resolution, state, resolution.value))
    return "the accelerations do not exist after an event";
  move_by(&resolution, time - zero);
  memcpy(instance->state, state, size);
  return NULL;
}

/* Lets frictions slide whose velocities an importer has set in event mode. */
static void release_frictions(struct Instance *instance) {
  const struct FrictionLaws *laws = lagrangian.switches->friction_laws;
  if (laws == NULL || instance->fmu_state->changed != CHANGED_VALUES) return;
  struct Resolution resolution = resolution_at(instance, instance->fmu_state->time, instance->state, IN_EXCHANGE);
  if (resolution_evaluate(&resolution)) laws->release(&resolution);
}

/* Largest residual by an integrator, in units of the scales of the state; a state further away was set. */
static const double largest_deviation = 1e-3;

/*
 * Projects the state for the present modes before these are judged. The residual of an integrator is no motion: a
 * closed contact would take a rate of -1e-6 m/s for an impact. The state also follows small changes of parameters.
 */
static void return_to_constraints(struct Instance *instance) {
  double *state = instance->event_state;
  size_t size = lagrangian.state_count * sizeof *state;
  if (lagrangian.constraints.projection == NULL || evaluate_prepare(instance) != STATUS_DONE) return;
  memcpy(state, instance->state, size);
  double moved = lagrangian.constraints.projection->project(instance, instance->fmu_state->time, state);
  if (moved > 0.0 && moved <= largest_deviation) memcpy(instance->state, state, size);
}

const char *exchange_resolve(struct Instance *instance) {
  const char *problem = NULL;
  bool passes = may_return(instance), changed;
  return_to_constraints(instance);
  for (int i = 0; i < LATE_LIMIT && passes && problem == NULL; i++) problem = pass_late(instance, &passes);
  if (problem != NULL) return problem;
  release_frictions(instance);
  return resolve(instance, instance->fmu_state->time, instance->state, IN_EXCHANGE, 0, &changed);
}
