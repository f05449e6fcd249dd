/* FMI for Model Exchange (section 3.2): the importer integrates; there are no events. */
#include <math.h>
#include <string.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"

fmi2Status fmi2EnterEventMode(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_ENTER_EVENT_MODE, "fmi2EnterEventMode")) return fmi2Error;
  instance->situation->mode = MODE_EVENT;
  return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_NEW_DISCRETE_STATES, "fmi2NewDiscreteStates") ||
      !check_array(instance, eventInfo, 1, "fmi2NewDiscreteStates", "eventInfo"))
    return fmi2Error;
  *eventInfo = (fmi2EventInfo){0};
  return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_ENTER_CONTINUOUS_TIME_MODE, "fmi2EnterContinuousTimeMode")) return fmi2Error;
  instance->situation->mode = MODE_CONTINUOUS_TIME;
  return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
  static const char *const name = "fmi2CompletedIntegratorStep";
  struct Instance *instance = c;
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_COMPLETED_INTEGRATOR_STEP, name) ||
      !check_array(instance, enterEventMode, 1, name, "enterEventMode") ||
      !check_array(instance, terminateSimulation, 1, name, "terminateSimulation"))
    return fmi2Error;
  *enterEventMode = *terminateSimulation = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SET_TIME, "fmi2SetTime")) return fmi2Error;
  if (!isfinite(time)) return log_error(instance, "fmi2SetTime: the time is %g; expected a finite number", time);
  instance->situation->time = time;
  return fmi2OK;
}

/* Whether an array of states is there and has as many elements as the FMU has states. */
static bool check_states(struct Instance *instance, const void *array, size_t count, const char *function) {
  if (count != lagrangian.state_count) {
    log_error(instance, "%s: %zu elements; expected %zu, the number of states", function, count,
              lagrangian.state_count);
    return false;
  }
  return check_array(instance, array, count, function, "the array");
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SET_CONTINUOUS_STATES, "fmi2SetContinuousStates") ||
      !check_states(instance, x, nx, "fmi2SetContinuousStates"))
    return fmi2Error;
  for (size_t i = 0; i < nx; i++)
    if (!isfinite(x[i]))
      return log_error(instance, "fmi2SetContinuousStates: state %zu is %g; expected a finite number", i + 1, x[i]);
  if (nx > 0) memcpy(instance->state, x, nx * sizeof *x);
  return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_CONTINUOUS, "fmi2GetDerivatives") ||
      !check_states(instance, derivatives, nx, "fmi2GetDerivatives"))
    return fmi2Error;
  if (nx == 0) return fmi2OK;
  fmi2Status status = evaluate_prepare(instance);
  if (status != fmi2OK) return status;
  struct Point point = evaluate_point(instance);
  if (!evaluate_derivatives(instance, &point, instance->work)) {
    log_singularity(instance, fmi2Discard, point.time);
    return fmi2Discard;
  }
  memcpy(derivatives, instance->work, nx * sizeof *derivatives);
  return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni) {
  struct Instance *instance = c;
  (void)eventIndicators;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_CONTINUOUS, "fmi2GetEventIndicators")) return fmi2Error;
  if (ni == 0) return fmi2OK;
  return log_error(instance, "fmi2GetEventIndicators: %zu elements; expected 0", ni);
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_CONTINUOUS, "fmi2GetContinuousStates") ||
      !check_states(instance, x, nx, "fmi2GetContinuousStates"))
    return fmi2Error;
  if (nx > 0) memcpy(x, instance->state, nx * sizeof *x);
  return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_NOMINALS, "fmi2GetNominalsOfContinuousStates") ||
      !check_states(instance, x_nominal, nx, "fmi2GetNominalsOfContinuousStates"))
    return fmi2Error;
  if (nx > 0) memcpy(x_nominal, lagrangian.nominal, nx * sizeof *x_nominal);
  return fmi2OK;
}
