#include "fmi/model_exchange.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "fmi/check.h"
#include "instance/projection.h"
#include "instance/event_laws.h"
#include "instance/time_laws.h"
#include "stepping/reading.h"

/*
 * Sets the time, which may go back only within the last step of the importer. It must not go beyond the second last
 * completed step or the last event (FMI 2.0.4, section 3.2.1; FMI 3.0.2, section 3.2.1).
 */
enum Status exchange_set_time(struct Instance *instance, double time) {
  double start = instance->fmu_state->start_time, earliest = instance->fmu_state->last_step.start;
  if (!isfinite(time)) return reject_call(instance, "the time is %g; expected a finite number", time);
  if (time < start)
    return reject_call(instance, "the time is %.15g; expected none before startTime %.15g", time, start);
  if (time < earliest - 8.0 * DBL_EPSILON * fabs(earliest))
    return reject_call(instance,
                       "the time is %.15g; expected none before %.15g, that of the last event or of the second last "
                       "completed step; restore a saved state to go back further",
                       time, earliest);
  instance->fmu_state->time = time;
  return STATUS_DONE;
}

/* True if the array exists and has an element for each state. */
static bool check_states(struct Instance *instance, const void *array, size_t count) {
  if (count == lagrangian.state_count) return check_array(instance, array, count, "the array");
  reject_call(instance, "the array has %zu elements; expected %zu, the number of states", count,
              lagrangian.state_count);
  return false;
}

/* Discards infinite states: an integrator that went too far may try a shorter step. */
enum Status exchange_set_states(struct Instance *instance, const double *state, size_t count) {
  if (!check_states(instance, state, count)) return STATUS_ERROR;
  for (size_t i = 0; i < count; i++)
    if (!isfinite(state[i]))
      return discard_call(instance, "state %zu is %g; expected a finite number", i + 1, state[i]);
  if (count > 0) memcpy(instance->state, state, count * sizeof *state);
  return STATUS_DONE;
}

enum Status exchange_get_states(struct Instance *instance, double *state, size_t count) {
  if (!check_states(instance, state, count)) return STATUS_ERROR;
  reading_begin(instance);
  if (count > 0) memcpy(state, instance->state, count * sizeof *state);
  reading_end(instance);
  return STATUS_DONE;
}

enum Status exchange_get_derivatives(struct Instance *instance, double *derivative, size_t count) {
  if (!check_states(instance, derivative, count)) return STATUS_ERROR;
  if (count == 0) return STATUS_DONE;
  reading_begin(instance);
  enum Status status = evaluate_fmu_state(instance, instance->work);
  if (status == STATUS_DONE) memcpy(derivative, instance->work, count * sizeof *derivative);
  reading_end(instance);
  return status;
}

enum Status exchange_get_nominals(struct Instance *instance, double *nominal, size_t count) {
  if (!check_states(instance, nominal, count)) return STATUS_ERROR;
  /* without states nominal is NULL, which memcpy() must not get; compilers see that and warn */
  if (lagrangian.state_count > 0) memcpy(nominal, lagrangian.steps.nominal, count * sizeof *nominal);
  return STATUS_DONE;
}

enum Status exchange_get_event_indicators(struct Instance *instance, double *indicator, size_t count) {
  size_t expected = indicator_count(lagrangian.switches);
  if (count != expected)
    return reject_call(instance, "the array has %zu elements; expected %zu, the number of event indicators", count,
                       expected);
  if (count == 0) return STATUS_DONE;
  if (!check_array(instance, indicator, count, "the array")) return STATUS_ERROR;
  reading_begin(instance);
  bool has_values = lagrangian.event_laws->indicators(instance, indicator);
  enum Status status = has_values ? STATUS_DONE : discard_for_singularity(instance);
  reading_end(instance);
  return status;
}

/*
 * Reports an error for computations past stopTime (FMI 2.0.4, section 2.1.6; FMI 3.0.2, section 2.3.2). Completed steps
 * and events count. Trial points of an integrator do not: CVode steps past the last output, and interpolates back.
 */
static enum Status check_stop_time(struct Instance *instance) {
  const struct FmuState *fmu_state = instance->fmu_state;
  double time = fmu_state->time, stop = fmu_state->stop_time;
  double rounding = 8.0 * DBL_EPSILON * fabs(time) + 1e-6 * fmax(0.0, time - fmu_state->last_step.end);
  if (!fmu_state->stop_time_defined || time - stop <= rounding) return STATUS_DONE;
  return reject_call(instance, "the time is %.15g; expected none past stopTime %.15g", time, stop);
}

enum Status exchange_enter_event_mode(struct Instance *instance) {
  struct FmuState *fmu_state = instance->fmu_state;
  if (check_stop_time(instance) != STATUS_DONE) return STATUS_ERROR;
  if (fmu_state->phase != PHASE_EVENT) fmu_state->update = UPDATE_MISSING;
  if (fmu_state->phase == PHASE_CONTINUOUS_TIME) {
    /* States set from here on may jump; those set before follow the motion. */
    fmu_state->changed = CHANGED_NOTHING;
    fmu_state_begin(fmu_state, fmu_state->time);
  }
  fmu_state->phase = PHASE_EVENT;
  return STATUS_DONE;
}

/* Returns NULL if the system has no time events. */
static const struct TimeLaws *laws_of_time(void) {
  return lagrangian.switches != NULL ? lagrangian.switches->time_laws : NULL;
}

bool exchange_is_event_due(struct Instance *instance) {
  const struct TimeLaws *times = laws_of_time();
  if (lagrangian.event_laws == NULL) return false;
  return lagrangian.event_laws->is_due(instance) || (times != NULL && times->is_due(instance));
}

/* Redundant constraints can be recognized while the state fulfils all of them, as after an event. */
static void note_redundant(struct Instance *instance) {
  const struct Projection *constraints = lagrangian.constraints.projection;
  if (constraints == NULL || evaluate_prepare(instance) != STATUS_DONE) return;
  bool is_known = isfinite(constraints->drift(instance, instance->fmu_state->time));
  instance->fmu_state->has_redundant = is_known && constraints->found_redundant(instance) ? 1 : 0;
}

/*
 * Importers update the discrete states in each event mode (FMI 2.0.4, section 3.2.2; FMI 3.0.2, section 2.3.5). Some do
 * not after the initialization (pathsim 0.27), which changes nothing unless an event is due.
 */
enum Status exchange_leave_event_mode(struct Instance *instance) {
  struct FmuState *fmu_state = instance->fmu_state;
  bool is_exchange = instance->kind == KIND_MODEL_EXCHANGE;
  bool needs_update = fmu_state->update == UPDATE_MISSING || (is_exchange && fmu_state->update == UPDATE_BEFORE_CHANGE);
  if (needs_update && exchange_is_event_due(instance))
    return reject_call(instance, "an event is due; expected an update of the discrete states before it");
  fmu_state->phase = is_exchange ? PHASE_CONTINUOUS_TIME : PHASE_STEP_COMPLETE;
  if (is_exchange) note_redundant(instance);
  return STATUS_DONE;
}

/*
 * Tolerance e of an importer that passes none, as FMPy in model exchange. Where its integrator is more exact, the drift
 * is smaller, and few projections are as exact as many.
 */
static const double usual_tolerance = 1e-6;

static double tolerance_of_importer(const struct FmuState *fmu_state) {
  bool is_default = fmu_state->tolerance == lagrangian.steps.tolerance;
  return is_default ? fmax(fmu_state->tolerance, usual_tolerance) : fmu_state->tolerance;
}

/*
 * True if the state must be projected onto the constraints, which takes an event.
 *
 * The importer's integrator errs by up to the tolerance e in each step, and so by up to n e after n steps. The drift d
 * is the part of this error across the constraints. It changes the forces, and so the motion along the constraints, by
 * an error of the order of d. While d < n e, this does not exceed the error along the constraints. After an event the
 * integrator starts at order 1 with short steps, so more events would cost time and accuracy. The drift grows with n^2,
 * since errors of velocities add up, so the first steps need no event. In long runs, d^2 < e keeps terms of second
 * order below the tolerance.
 */
static bool has_drifted(struct Instance *instance) {
  const struct FmuState *fmu_state = instance->fmu_state;
  if (lagrangian.constraints.projection == NULL || evaluate_prepare(instance) != STATUS_DONE) return false;
  double drift = lagrangian.constraints.projection->drift(instance, fmu_state->time);
  double tolerance = tolerance_of_importer(fmu_state);
  return drift > fmin((double)fmu_state->completed_steps * tolerance, sqrt(tolerance));
}

enum Status exchange_complete_step(struct Instance *instance, bool *needs_event) {
  struct FmuState *fmu_state = instance->fmu_state;
  if (check_stop_time(instance) != STATUS_DONE) return STATUS_ERROR;
  fmu_state->completed_steps++;
  fmu_state->last_step = (struct Span){fmin(fmu_state->last_step.end, fmu_state->time), fmu_state->time};
  fmu_state->searched = fmu_state->last_step.start;
  *needs_event = has_drifted(instance) || (lagrangian.event_laws != NULL && lagrangian.event_laws->is_due(instance));
  return STATUS_DONE;
}

/* Brings the modes into agreement with the state. */
static enum Status resolve_modes(struct Instance *instance) {
  const struct EventLaws *laws = lagrangian.event_laws;
  if (laws == NULL) return STATUS_DONE;
  const char *problem = instance->kind == KIND_CO_SIMULATION ? laws->update(instance) : laws->resolve(instance);
  return problem == NULL ? STATUS_DONE : log_error(instance, "time %g: %s", instance->fmu_state->time, problem);
}

/* Brings the modes into agreement with the state, and projects it. */
static enum Status update_state(struct Instance *instance) {
  instance->fmu_state->update = UPDATE_DONE;
  enum Status status = resolve_modes(instance);
  memcpy(instance->fmu_state->reported_statistics, instance->fmu_state->statistics,
         sizeof instance->fmu_state->statistics);
  if (status != STATUS_DONE || lagrangian.constraints.projection == NULL || instance->kind == KIND_CO_SIMULATION)
    return status;
  status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  double moved = lagrangian.constraints.projection->project(instance, instance->fmu_state->time, instance->state);
  if (!isfinite(moved)) {
    double time = instance->fmu_state->time;
    log_violated(instance, STATUS_ERROR, time, lagrangian.constraints.projection->violated_constraint(instance, time));
    return log_error(instance, "time %g: the constraints cannot be fulfilled", time);
  }
  return STATUS_DONE;
}

enum Status exchange_update(struct Instance *instance, bool *states_changed) {
  size_t size = lagrangian.state_count * sizeof *instance->state;
  uint64_t before = instance_checksum(instance->state, size);
  enum Status status = update_state(instance);
  *states_changed = instance_checksum(instance->state, size) != before;
  return status;
}

bool exchange_next_event(struct Instance *instance, double *time) {
  const struct TimeLaws *laws = laws_of_time();
  *time = 0.0;
  return laws != NULL && evaluate_prepare(instance) == STATUS_DONE && laws->next(instance, time);
}
