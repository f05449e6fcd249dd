#include "stepping/start.h"

#include "evaluation/evaluate.h"
#include "instance/initial_state.h"
#include "instance/projection.h"
#include "instance/event_laws.h"

static bool is_parameter_constants(struct Instance *instance) {
  instance->singular = lagrangian.prepare(instance->parameter, instance->parameter_constants);
  if (instance->singular == 0) instance->parameter_constants_are_stale = false;
  return instance->singular == 0;
}

static bool has_accelerations(struct Instance *instance) {
  struct Point point = instance_point(instance);
  return lagrangian.derivatives == NULL || evaluate_derivatives(instance, &point, instance->work);
}

enum Status start_find(struct Instance *instance) {
  if (initial_state_check(instance) != STATUS_DONE) return STATUS_ERROR;
  if (lagrangian.event_laws != NULL) lagrangian.event_laws->guess(instance);
  bool is_ready = is_parameter_constants(instance);
  if (is_ready && lagrangian.constraints.projection != NULL &&
      !lagrangian.constraints.projection->make_consistent(instance))
    return STATUS_ERROR;
  if (is_ready && lagrangian.event_laws != NULL && !lagrangian.event_laws->start(instance)) return STATUS_ERROR;
  if (is_ready && has_accelerations(instance)) return STATUS_DONE;
  log_singularity(instance, STATUS_ERROR, instance->fmu_state->time);
  const char *state = is_ready ? evaluate_rate_without_value(instance) : NULL;
  if (state != NULL) return reject_call(instance, "the rate of '%s' cannot be computed at the start values", state);
  return reject_call(instance, "the accelerations cannot be computed at the start values");
}

bool start_step(struct Instance *instance) {
  double time = instance->fmu_state->time;
  if (lagrangian.event_laws != NULL && !lagrangian.event_laws->part(instance, time)) return false;
  if (lagrangian.constraints.projection != NULL && !lagrangian.constraints.projection->follow_change(instance))
    return false;
  return lagrangian.event_laws == NULL || lagrangian.event_laws->resolve_change(instance, time);
}
