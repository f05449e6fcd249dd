/* FMI for Co-Simulation (section 4.2): communication steps. */
#include "fmi/check.h"
#include "fmi/life_cycle.h"
#include "fmi2/fmi2_component.h"
#include "stepping/steps.h"

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
  struct Instance *instance = enter(c, FUNCTION_DO_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL) return fmi2Error;
  return status_of(communication_step(instance, currentCommunicationPoint, communicationStepSize));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
  enter(c, FUNCTION_NEVER, __func__);
  return fmi2Error;
}

/* Returns fmi2Discard for a status that does not exist: steps are never pending. */
static fmi2Status unknown_status(fmi2Component c, const char *name) {
  struct Instance *instance = enter(c, FUNCTION_GET_STATUS, name);
  if (instance == NULL) return fmi2Error;
  log_message(instance, STATUS_DISCARD, "%s: no step is pending, so there is no such status", name);
  return fmi2Discard;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
  if (s != fmi2LastSuccessfulTime) return unknown_status(c, __func__);
  struct Instance *instance = enter(c, FUNCTION_GET_STATUS, __func__);
  if (instance == NULL || !check_array(instance, value, 1, "value")) return fmi2Error;
  *value = instance->fmu_state->time;
  return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
  if (s != fmi2Terminated) return unknown_status(c, __func__);
  struct Instance *instance = enter(c, FUNCTION_GET_STATUS, __func__);
  if (instance == NULL || !check_array(instance, value, 1, "value")) return fmi2Error;
  *value = fmi2False;
  return fmi2OK;
}

/* Defines a function that returns fmi2Discard, as no status has this type. */
#define NO_STATUS(function, type)                                                                                      \
  fmi2Status function(fmi2Component c, const fmi2StatusKind s, fmi2##type *value) {                                    \
    (void)s;                                                                                                           \
    (void)value;                                                                                                       \
    return unknown_status(c, __func__);                                                                                \
  }

NO_STATUS(fmi2GetStatus, Status)
NO_STATUS(fmi2GetIntegerStatus, Integer)
NO_STATUS(fmi2GetStringStatus, String)
