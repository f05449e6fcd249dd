#include "fmi/simulation.h"

#include <math.h>
#include <string.h>

#include "stepping/start.h"

enum Status simulation_set_up(struct Instance *instance, const struct Experiment *experiment) {
  double start = experiment->start_time, stop = experiment->stop_time, tolerance = experiment->tolerance;
  if (!isfinite(start)) return refuse_call(instance, "startTime is %g; expected a finite number", start);
  if (experiment->has_stop_time && !(stop >= start && isfinite(stop)))
    return refuse_call(instance, "stopTime is %g; expected a finite number from startTime %g on", stop, start);
  if (experiment->has_tolerance && !(tolerance > 0.0 && tolerance < 1.0))
    return refuse_call(instance, "tolerance is %g; expected one between 0 and 1", tolerance);
  struct Situation *situation = instance->situation;
  situation->experiment_defined = 1;
  situation->stop_time_defined = experiment->has_stop_time ? 1 : 0;
  situation->time = situation->start_time = start;
  situation->stop_time = experiment->has_stop_time ? stop : 0.0;
  situation->tolerance = experiment->has_tolerance ? tolerance : lagrangian.steps.tolerance;
  return STATUS_DONE;
}

enum Status simulation_start(struct Instance *instance) {
  if (start_find(instance) != STATUS_DONE) return STATUS_ERROR;
  instance->situation->phase = instance->kind == KIND_MODEL_EXCHANGE ? PHASE_EVENT : PHASE_STEP_COMPLETE;
  instance->situation->changed = CHANGED_COURSE;
  situation_begin(instance->situation, instance->situation->time);
  memcpy(instance->situation->reported_statistics, instance->situation->statistics,
         sizeof instance->situation->statistics);
  instance->lacks_update = true;
  log_message(instance, STATUS_DONE, "initialised at time %g", instance->situation->time);
  return STATUS_DONE;
}

void simulation_terminate(struct Instance *instance) {
  instance->situation->phase = PHASE_TERMINATED;
  log_message(instance, STATUS_DONE, "terminated at time %g", instance->situation->time);
}
