/*
 * FMI 3.0 without values and communication steps: version, initialization, end, saved states (sections 2.2.10 and 2.3),
 * events and model exchange (section 3.2).
 */
#include "fmi/life_cycle.h"
#include "fmi3/fmi3_component.h"

#define FMI(name) fmi3##name
#define NOMINALS FUNCTION_GET_CONTINUOUS
#define QUIET_CATEGORIES 0
#include "fmi/shared_functions.h"

const char *fmi3GetVersion(void) {
  return "3.0";
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) {
  struct Instance *instance = enter(c, FUNCTION_SET_UP, __func__);
  if (instance == NULL) return fmi3Error;
  struct ExperimentSetup experiment = {.start_time = startTime,
                                       .stop_time = stopTime,
                                       .tolerance = tolerance,
                                       .has_stop_time = stopTimeDefined,
                                       .has_tolerance = toleranceDefined};
  enum Status status = simulation_set_up(instance, &experiment);
  if (status == STATUS_DONE) instance->fmu_state->phase = PHASE_INITIALIZATION;
  return status_of(status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_EXIT_INITIALIZATION_MODE, __func__);
  if (instance == NULL) return fmi3Error;
  enum Status status = simulation_start(instance);
  if (status == STATUS_DONE && instance->uses_event_mode) instance->fmu_state->phase = PHASE_EVENT;
  return status_of(status);
}

/* There are no structural parameters to configure. */
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
  enter(c, FUNCTION_NEVER, __func__);
  return fmi3Error;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
  enter(c, FUNCTION_NEVER, __func__);
  return fmi3Error;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_EVENT_MODE_OF_STEPS, __func__);
  if (instance == NULL) return fmi3Error;
  if (instance->kind == KIND_CO_SIMULATION && !instance->uses_event_mode)
    return status_of(log_error(instance,
                               "%s is not allowed in the state '%s' of an instance that was made with eventModeUsed "
                               "false; expected true",
                               __func__, instance_phase_name(instance)));
  return status_of(exchange_enter_event_mode(instance));
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
  enter(c, FUNCTION_NEVER, __func__);
  return fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime) {
  struct Instance *instance = enter(c, FUNCTION_UPDATE_DISCRETE_STATES, __func__);
  if (instance == NULL || !check_array(instance, discreteStatesNeedUpdate, 1, "discreteStatesNeedUpdate") ||
      !check_array(instance, terminateSimulation, 1, "terminateSimulation") ||
      !check_array(instance, nominalsOfContinuousStatesChanged, 1, "nominalsOfContinuousStatesChanged") ||
      !check_array(instance, valuesOfContinuousStatesChanged, 1, "valuesOfContinuousStatesChanged") ||
      !check_array(instance, nextEventTimeDefined, 1, "nextEventTimeDefined") ||
      !check_array(instance, nextEventTime, 1, "nextEventTime"))
    return fmi3Error;
  *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
  *nextEventTimeDefined = fmi3False;
  *nextEventTime = 0.0;
  enum Status status = exchange_update(instance, valuesOfContinuousStatesChanged);
  if (status == STATUS_DONE) *nextEventTimeDefined = exchange_next_event(instance, nextEventTime);
  return status_of(status);
}

static fmi3Status get_count(fmi3Instance c, size_t count, size_t *value, const char *name, const char *argument) {
  struct Instance *instance = enter(c, FUNCTION_GET_COUNT, name);
  if (instance == NULL || !check_array(instance, value, 1, argument)) return fmi3Error;
  *value = count;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators) {
  return get_count(c, indicator_count(lagrangian.switches), nEventIndicators, __func__, "nEventIndicators");
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates) {
  return get_count(c, lagrangian.state_count, nContinuousStates, __func__, "nContinuousStates");
}
