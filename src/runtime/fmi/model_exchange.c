#include "fmi/model_exchange.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "fmi/check.h"
#include "instance/projection.h"
#include "instance/event_laws.h"
#include "stepping/reading.h"

enum Status exchange_set_time(struct Instance *instance, double time) {
  if (!isfinite(time)) return refuse_call(instance, "the time is %g; expected a finite number", time);
  instance->situation->time = time;
  return STATUS_DONE;
}

/* Whether an array of states has their number. */
static bool check_states(struct Instance *instance, const void *array, size_t count) {
  if (count == lagrangian.state_count) return check_array(instance, array, count, "the array");
  refuse_call(instance, "%zu elements; expected %zu, the number of states", count, lagrangian.state_count);
  return false;
}

enum Status exchange_set_states(struct Instance *instance, const double *state, size_t count) {
  if (!check_states(instance, state, count)) return STATUS_ERROR;
  for (size_t i = 0; i < count; i++)
    if (!isfinite(state[i])) return refuse_call(instance, "state %zu is %g; expected a finite number", i + 1, state[i]);
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
  enum Status status = evaluate_situation(instance, instance->work);
  if (status == STATUS_DONE) memcpy(derivative, instance->work, count * sizeof *derivative);
  reading_end(instance);
  return status;
}

enum Status exchange_get_nominals(struct Instance *instance, double *nominal, size_t count) {
  if (!check_states(instance, nominal, count)) return STATUS_ERROR;
  if (count > 0) memcpy(nominal, lagrangian.steps.nominal, count * sizeof *nominal);
  return STATUS_DONE;
}

enum Status exchange_get_event_indicators(struct Instance *instance, double *indicator, size_t count) {
  size_t expected = indicator_count(lagrangian.switches);
  if (count != expected)
    return refuse_call(instance, "%zu elements; expected %zu, the number of event indicators", count, expected);
  if (count == 0) return STATUS_DONE;
  if (!check_array(instance, indicator, count, "the array")) return STATUS_ERROR;
  reading_begin(instance);
  bool has_values = lagrangian.event_laws->indicators(instance, indicator);
  enum Status status = has_values ? STATUS_DONE : discard_for_singularity(instance);
  reading_end(instance);
  return status;
}

static bool has_drifted(struct Instance *instance) {
  if (lagrangian.constraints.projection == NULL || evaluate_prepare(instance) != STATUS_DONE) return false;
  return lagrangian.constraints.projection->drift(instance, instance->situation->time) > instance->situation->tolerance;
}

bool exchange_needs_event(struct Instance *instance) {
  return has_drifted(instance) || (lagrangian.event_laws != NULL && lagrangian.event_laws->is_due(instance));
}

/* Brings the modes into agreement with the state. */
static enum Status settle_modes(struct Instance *instance, bool *changed) {
  const struct EventLaws *laws = lagrangian.event_laws;
  if (laws == NULL) return STATUS_DONE;
  const char *problem = instance->kind == KIND_CO_SIMULATION ? laws->update(instance, changed)
                                                             : laws->settle(instance, instance->situation->time,
                                                                            instance->state, IN_EXCHANGE, 0, changed);
  return problem == NULL ? STATUS_DONE : log_error(instance, "time %g: %s", instance->situation->time, problem);
}

enum Status exchange_update(struct Instance *instance, bool *states_changed) {
  *states_changed = false;
  enum Status status = settle_modes(instance, states_changed);
  if (status != STATUS_DONE || lagrangian.constraints.projection == NULL || instance->kind == KIND_CO_SIMULATION)
    return status;
  status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  double moved = lagrangian.constraints.projection->project(instance, instance->situation->time, instance->state);
  if (!isfinite(moved))
    return log_error(instance, "time %g: the constraints cannot be fulfilled here", instance->situation->time);
  *states_changed |= moved > 0.0;
  return STATUS_DONE;
}
