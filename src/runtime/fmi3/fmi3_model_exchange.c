/* FMI for Model Exchange (section 3.2): the importer integrates. */
#include "fmi/check.h"
#include "fmi/model_exchange.h"
#include "fmi3/fmi3_life_cycle.h"

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_EVENT_MODE, __func__);
  if (instance == NULL) return fmi3Error;
  if (instance->kind == KIND_CO_SIMULATION && !instance->uses_event_mode)
    return fmi3_status(log_error(instance,
                                 "%s is not allowed in the state '%s' of an instance that was made with eventModeUsed "
                                 "false; expected true",
                                 __func__, instance_mode_name(instance)));
  instance->situation->mode = MODE_EVENT;
  return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_CONTINUOUS_TIME_MODE, __func__);
  if (instance == NULL) return fmi3Error;
  instance->situation->mode = MODE_CONTINUOUS_TIME;
  return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
  enter(c, FUNCTION_EVALUATE_DISCRETE_STATES, __func__);
  return fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime) {
  struct Instance *instance = enter(c, FUNCTION_UPDATE_DISCRETE_STATES, __func__);
  if (instance == NULL || !check_array(instance, discreteStatesNeedUpdate, 1, __func__, "discreteStatesNeedUpdate") ||
      !check_array(instance, terminateSimulation, 1, __func__, "terminateSimulation") ||
      !check_array(instance, nominalsOfContinuousStatesChanged, 1, __func__, "nominalsOfContinuousStatesChanged") ||
      !check_array(instance, valuesOfContinuousStatesChanged, 1, __func__, "valuesOfContinuousStatesChanged") ||
      !check_array(instance, nextEventTimeDefined, 1, __func__, "nextEventTimeDefined") ||
      !check_array(instance, nextEventTime, 1, __func__, "nextEventTime"))
    return fmi3Error;
  *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
  *nextEventTimeDefined = fmi3False;
  *nextEventTime = 0.0;
  return fmi3_status(exchange_update(instance, valuesOfContinuousStatesChanged));
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation) {
  struct Instance *instance = enter(c, FUNCTION_COMPLETED_INTEGRATOR_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL || !check_array(instance, enterEventMode, 1, __func__, "enterEventMode") ||
      !check_array(instance, terminateSimulation, 1, __func__, "terminateSimulation"))
    return fmi3Error;
  *enterEventMode = exchange_needs_event(instance);
  *terminateSimulation = fmi3False;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
  struct Instance *instance = enter(c, FUNCTION_SET_TIME, __func__);
  return instance == NULL ? fmi3Error : fmi3_status(exchange_set_time(instance, time, __func__));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 continuousStates[], size_t nContinuousStates) {
  struct Instance *instance = enter(c, FUNCTION_SET_CONTINUOUS_STATES, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(exchange_set_states(instance, continuousStates, nContinuousStates, __func__));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t nContinuousStates) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(exchange_get_derivatives(instance, derivatives, nContinuousStates, __func__));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 eventIndicators[], size_t nEventIndicators) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(exchange_get_event_indicators(instance, eventIndicators, nEventIndicators, __func__));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 continuousStates[], size_t nContinuousStates) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(exchange_get_states(instance, continuousStates, nContinuousStates, __func__));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nContinuousStates) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(exchange_get_nominals(instance, nominals, nContinuousStates, __func__));
}

static fmi3Status get_count(fmi3Instance c, size_t count, size_t *value, const char *name, const char *argument) {
  struct Instance *instance = enter(c, FUNCTION_GET_COUNT, name);
  if (instance == NULL || !check_array(instance, value, 1, name, argument)) return fmi3Error;
  *value = count;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators) {
  return get_count(c, indicator_count(lagrangian.switches), nEventIndicators, __func__, "nEventIndicators");
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates) {
  return get_count(c, lagrangian.state_count, nContinuousStates, __func__, "nContinuousStates");
}
