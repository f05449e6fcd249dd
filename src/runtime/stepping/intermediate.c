#include "stepping/intermediate.h"

#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"

/* Gives the instance the values of a time within the step. False if they do not exist. */
static bool move_to(struct Instance *instance, double time) {
  if (!solver_take_state(instance, time) || solver_project(instance, time, instance->state) != NULL) return false;
  evaluate_advance_inputs(instance, time); /* from the time of the situation */
  instance->situation->time = time;
  instance->situation->phase = PHASE_INTERMEDIATE_UPDATE;
  return true;
}

void intermediate_observe(struct Instance *instance, struct CommunicationStep *step, double time) {
  const struct Intermediate *intermediate = instance->intermediate;
  int singular = instance->singular;
  double end = step->end;
  memcpy(intermediate->kept, instance->situation, situation_size());
  bool has_values = move_to(instance, time);
  if (has_values) end = intermediate->update(intermediate->receiver, time, end);
  bool failed = instance->situation->phase == PHASE_ERROR;
  memcpy(instance->situation, intermediate->kept, situation_size());
  instance->singular = singular;
  if (failed) {
    instance->situation->phase = PHASE_ERROR;
    end = time;
  }
  if (!(end < step->end)) return;
  step->end = fmax(time, end);
  step->length = step->end - step->start;
}
