/* FMI for Model Exchange (section 3.2): the importer integrates. */
#include "fmi/check.h"
#include "fmi/model_exchange.h"
#include "fmi2/fmi2_life_cycle.h"

static fmi2Status change_mode(fmi2Component c, enum Function function, const char *name, enum Mode mode) {
  struct Instance *instance = enter(c, function, name);
  if (instance == NULL) return fmi2Error;
  instance->situation->mode = (int32_t)mode;
  return fmi2OK;
}

fmi2Status fmi2EnterEventMode(fmi2Component c) {
  return change_mode(c, FUNCTION_ENTER_EVENT_MODE, __func__, MODE_EVENT);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  return change_mode(c, FUNCTION_ENTER_CONTINUOUS_TIME_MODE, __func__, MODE_CONTINUOUS_TIME);
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo) {
  struct Instance *instance = enter(c, FUNCTION_NEW_DISCRETE_STATES, __func__);
  if (instance == NULL || !check_array(instance, eventInfo, 1, __func__, "eventInfo")) return fmi2Error;
  *eventInfo = (fmi2EventInfo){0};
  bool states_changed;
  enum Status status = exchange_update(instance, &states_changed);
  eventInfo->valuesOfContinuousStatesChanged = states_changed;
  return fmi2_status(status);
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
  struct Instance *instance = enter(c, FUNCTION_COMPLETED_INTEGRATOR_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL || !check_array(instance, enterEventMode, 1, __func__, "enterEventMode") ||
      !check_array(instance, terminateSimulation, 1, __func__, "terminateSimulation"))
    return fmi2Error;
  *enterEventMode = exchange_needs_event(instance);
  *terminateSimulation = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  struct Instance *instance = enter(c, FUNCTION_SET_TIME, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(exchange_set_time(instance, time, __func__));
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
  struct Instance *instance = enter(c, FUNCTION_SET_CONTINUOUS_STATES, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(exchange_set_states(instance, x, nx, __func__));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(exchange_get_derivatives(instance, derivatives, nx, __func__));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  if (instance == NULL) return fmi2Error;
  return fmi2_status(exchange_get_event_indicators(instance, eventIndicators, ni, __func__));
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(exchange_get_states(instance, x, nx, __func__));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx) {
  struct Instance *instance = enter(c, FUNCTION_GET_NOMINALS, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(exchange_get_nominals(instance, x_nominal, nx, __func__));
}
