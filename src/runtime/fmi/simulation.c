#include "fmi/simulation.h"

#include <math.h>
#include <string.h>

#include "stepping/start.h"

enum Status simulation_set_up(struct Instance *instance, const struct ExperimentSetup *experiment) {
  double start = experiment->start_time, stop = experiment->stop_time, tolerance = experiment->tolerance;
  if (!isfinite(start)) return reject_call(instance, "startTime is %g; expected a finite number", start);
  if (experiment->has_stop_time && !(stop >= start && isfinite(stop)))
    return reject_call(instance, "stopTime is %g; expected a finite number from startTime %g on", stop, start);
  if (experiment->has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))
    return reject_call(instance, "tolerance is %g; expected one between 0 and 1", tolerance);
  struct FmuState *fmu_state = instance->fmu_state;
  fmu_state->experiment_defined = 1;
  fmu_state->stop_time_defined = experiment->has_stop_time ? 1 : 0;
  fmu_state->time = fmu_state->start_time = start;
  fmu_state->stop_time = experiment->has_stop_time ? stop : 0.0;
  fmu_state->tolerance = experiment->has_tolerance ? tolerance : lagrangian.steps.tolerance;
  return STATUS_DONE;
}

enum Status simulation_start(struct Instance *instance) {
  if (start_find(instance) != STATUS_DONE) return STATUS_ERROR;
  instance->fmu_state->phase = instance->kind == KIND_MODEL_EXCHANGE ? PHASE_EVENT : PHASE_STEP_COMPLETE;
  instance->fmu_state->changed = CHANGED_COURSE;
  fmu_state_begin(instance->fmu_state, instance->fmu_state->time);
  memcpy(instance->fmu_state->reported_statistics, instance->fmu_state->statistics,
         sizeof instance->fmu_state->statistics);
  instance->fmu_state->update = UPDATE_MISSING;
  log_message(instance, STATUS_DONE, "initialised at time %g", instance->fmu_state->time);
  return STATUS_DONE;
}

void simulation_terminate(struct Instance *instance) {
  instance->fmu_state->phase = PHASE_TERMINATED;
  log_message(instance, STATUS_DONE, "terminated at time %g", instance->fmu_state->time);
}
