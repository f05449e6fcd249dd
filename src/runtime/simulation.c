#include "simulation.h"

#include <math.h>

#include "evaluate.h"
#include "initial_state.h"
#include "projection.h"
#include "switching.h"

enum Status simulation_set_up(struct Instance *instance, const struct Experiment *experiment, const char *function) {
  double start = experiment->start_time, stop = experiment->stop_time, tolerance = experiment->tolerance;
  if (!isfinite(start)) return log_error(instance, "%s: startTime is %g; expected a finite number", function, start);
  if (experiment->has_stop_time && !(stop >= start && isfinite(stop)))
    return log_error(instance, "%s: stopTime is %g; expected a finite number from startTime %g on", function, stop,
                     start);
  if (experiment->has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))
    return log_error(instance, "%s: tolerance is %g; expected one between 0 and 1", function, tolerance);
  struct Situation *situation = instance->situation;
  situation->experiment_defined = 1;
  situation->stop_time_defined = experiment->has_stop_time ? 1 : 0;
  situation->time = situation->start_time = start;
  situation->stop_time = experiment->has_stop_time ? stop : 0.0;
  situation->tolerance = experiment->has_tolerance ? tolerance : lagrangian.tolerance;
  return STATUS_DONE;
}

static bool is_prepared(struct Instance *instance) {
  instance->singular = lagrangian.prepare(instance->parameter, instance->prepared);
  if (instance->singular == 0) instance->prepared_is_stale = false;
  return instance->singular == 0;
}

static bool has_accelerations(struct Instance *instance) {
  struct Point point = evaluate_point(instance);
  return lagrangian.derivatives == NULL || evaluate_derivatives(instance, &point, instance->work);
}

enum Status simulation_start(struct Instance *instance, const char *function) {
  if (initial_state_check(instance, function) != STATUS_DONE) return STATUS_ERROR;
  if (lagrangian.switching != NULL) lagrangian.switching->guess(instance);
  bool is_ready = is_prepared(instance);
  if (is_ready && lagrangian.projection != NULL && !lagrangian.projection->make_consistent(instance, function))
    return STATUS_ERROR;
  if (is_ready && lagrangian.switching != NULL && !lagrangian.switching->start(instance, function)) return STATUS_ERROR;
  if (!is_ready || !has_accelerations(instance)) {
    log_singularity(instance, STATUS_ERROR, instance->situation->time);
    return log_error(instance, "%s: the system has no acceleration at its start values", function);
  }
  instance->situation->mode = instance->kind == KIND_MODEL_EXCHANGE ? MODE_EVENT : MODE_STEP_COMPLETE;
  instance->situation->changed = CHANGED_COURSE;
  log_message(instance, STATUS_DONE, "initialised at time %g", instance->situation->time);
  return STATUS_DONE;
}

void simulation_terminate(struct Instance *instance) {
  instance->situation->mode = MODE_TERMINATED;
  log_message(instance, STATUS_DONE, "terminated at time %g", instance->situation->time);
}
