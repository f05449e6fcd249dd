/* FMI for Co-Simulation (section 4.2): communication steps, and intermediate update within them. */
#include <string.h>

#include "fmi/check.h"
#include "fmi/life_cycle.h"
#include "fmi/model_exchange.h"
#include "fmi3/fmi3_component.h"
#include "stepping/steps.h"

/* Calls the importer back. Returns the requested end of the step; end if it stays. */
static double call_back(struct FmiComponent *component, double time, double end) {
  bool can_return_early = component->early_return_allowed && time < end;
  fmi3Boolean requested = fmi3False;
  fmi3Float64 requested_time = time;
  const char *function = component->instance.function; /* the importer may call other functions */
  component->intermediate_update(component->environment, time, fmi3False, fmi3True, fmi3True, can_return_early,
                                 &requested, &requested_time);
  component->instance.function = function;
  if (!can_return_early || !requested || !(requested_time < end)) return end;
  component->has_returned_early = true;
  return requested_time;
}

/* Requests the inputs at a time within the coming step. */
static void request(void *receiver, double time) {
  struct FmiComponent *component = receiver;
  fmi3Boolean requested = fmi3False;
  fmi3Float64 requested_time = time;
  const char *function = component->instance.function;
  component->intermediate_update(component->environment, time, fmi3True, fmi3False, fmi3False, fmi3False, &requested,
                                 &requested_time);
  component->instance.function = function;
}

static double update(void *receiver, double time, double end) {
  return call_back(receiver, time, end);
}

/* Calls back at the end of the step, in the state of the instance. */
static void update_at_end(struct FmiComponent *component) {
  struct FmuState *fmu_state = component->instance.fmu_state;
  if (component->intermediate_update == NULL) return;
  fmu_state->phase = PHASE_INTERMEDIATE_UPDATE;
  call_back(component, fmu_state->time, fmu_state->time);
  if (fmu_state->phase == PHASE_INTERMEDIATE_UPDATE) fmu_state->phase = PHASE_STEP_COMPLETE;
}

/* Observes the solver's steps if the importer wants intermediate updates. */
static void observe(struct FmiComponent *component) {
  if (component->intermediate_update == NULL) return;
  component->intermediate.update = update;
  component->intermediate.request = request;
  component->intermediate.receiver = component;
  component->instance.intermediate = &component->intermediate;
  component->instance.observe = intermediate_observe;
  if (component->sets_inputs) component->instance.request_inputs = intermediate_request_inputs;
}

/*
 * True if the importer must enter event mode at the end of the step. An importer without early return sees events
 * only at the end (FMI 3.0.2, section 4.2.1). Such an event is due there, or it was inside the step: the FMU has
 * handled it, and discrete variables differ.
 */
static bool needs_event_mode(struct Instance *instance, int64_t events_before) {
  if (instance->fmu_state->waiting_event != 0) return true;
  if (!instance->uses_event_mode || instance->stops_at_events) return false;
  return instance->fmu_state->statistics[STATISTIC_EVENTS] != events_before || exchange_is_event_due(instance);
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime) {
  struct FmiComponent *component = c;
  struct Instance *instance = enter(c, FUNCTION_DO_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL || !check_array(instance, eventHandlingNeeded, 1, "eventHandlingNeeded") ||
      !check_array(instance, terminateSimulation, 1, "terminateSimulation") ||
      !check_array(instance, earlyReturn, 1, "earlyReturn") ||
      !check_array(instance, lastSuccessfulTime, 1, "lastSuccessfulTime"))
    return fmi3Error;
  if (instance->fmu_state->waiting_event != 0)
    return status_of(reject_call(instance, "the previous step ended at an event; expected fmi3EnterEventMode, "
                                           "fmi3UpdateDiscreteStates and fmi3EnterStepMode"));
  memcpy(component->before, instance->fmu_state, fmu_state_size());
  component->has_returned_early = false;
  int64_t events_before = instance->fmu_state->statistics[STATISTIC_EVENTS];
  observe(component);
  enum Status status = communication_step(instance, currentCommunicationPoint, communicationStepSize);
  /*
   * The instance is restored to its state before the call (section 2.2.3); an early return would hide that the motion
   * ends.
   */
  if (status == STATUS_DISCARD) instance_restore(instance, component->before);
  if (status == STATUS_DONE && instance->fmu_state->phase == PHASE_STEP_COMPLETE) update_at_end(component);
  /* An error in the callback was logged. */
  if (instance->fmu_state->phase == PHASE_ERROR) status = STATUS_ERROR;
  bool is_at_event = status == STATUS_DONE && needs_event_mode(instance, events_before);
  bool is_early = is_at_event && instance->fmu_state->time < currentCommunicationPoint + communicationStepSize;
  *eventHandlingNeeded = is_at_event;
  *terminateSimulation = fmi3False;
  *earlyReturn = status == STATUS_DONE && (component->has_returned_early || is_early);
  *lastSuccessfulTime = instance->fmu_state->time;
  return status_of(status);
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_STEP_MODE, __func__);
  return instance == NULL ? fmi3Error : status_of(exchange_leave_event_mode(instance));
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference, fmi3Float64 activationTime) {
  (void)clockReference;
  (void)activationTime;
  enter(c, FUNCTION_NEVER, __func__);
  return fmi3Error;
}
