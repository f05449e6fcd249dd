/*
 * FMI for Model Exchange (section 3.2): the importer integrates. In an event modes may change, and a state that drifted from
 * the constraints is brought back.
 */
#include <math.h>
#include <string.h>

#include "check.h"
#include "evaluate.h"
#include "fmi2_life_cycle.h"
#include "projection.h"
#include "switching.h"

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

/* Brings the state back to the constraints. */
static enum Status project_in_event(struct Instance *instance, fmi2EventInfo *event) {
  enum Status status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  double moved = lagrangian.projection->project(instance, instance->situation->time, instance->state);
  if (!isfinite(moved))
    return log_error(instance, "time %g: the constraints cannot be fulfilled here", instance->situation->time);
  event->valuesOfContinuousStatesChanged = moved > 0.0;
  return STATUS_DONE;
}

/* Whether the state has drifted from the constraints by more than the tolerance. */
static bool has_drifted(struct Instance *instance) {
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  return lagrangian.projection->drift(instance, instance->situation->time) > instance->situation->tolerance;
}

/* Brings the modes into agreement with the state. */
static enum Status settle_in_event(struct Instance *instance, fmi2EventInfo *event) {
  bool changed;
  const char *problem =
      lagrangian.switching->settle(instance, instance->situation->time, instance->state, IN_EXCHANGE, 0, &changed);
  if (problem != NULL) return log_error(instance, "time %g: %s", instance->situation->time, problem);
  event->valuesOfContinuousStatesChanged = changed;
  return STATUS_DONE;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo) {
  struct Instance *instance = enter(c, FUNCTION_NEW_DISCRETE_STATES, __func__);
  if (instance == NULL || !check_array(instance, eventInfo, 1, __func__, "eventInfo")) return fmi2Error;
  *eventInfo = (fmi2EventInfo){0};
  enum Status status = STATUS_DONE;
  if (lagrangian.switching != NULL) status = settle_in_event(instance, eventInfo);
  bool has_settled = eventInfo->valuesOfContinuousStatesChanged;
  if (status == STATUS_DONE && lagrangian.projection != NULL) status = project_in_event(instance, eventInfo);
  if (has_settled) eventInfo->valuesOfContinuousStatesChanged = fmi2True;
  return fmi2_status(status);
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
  struct Instance *instance = enter(c, FUNCTION_COMPLETED_INTEGRATOR_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL || !check_array(instance, enterEventMode, 1, __func__, "enterEventMode") ||
      !check_array(instance, terminateSimulation, 1, __func__, "terminateSimulation"))
    return fmi2Error;
  *enterEventMode = (lagrangian.projection != NULL && has_drifted(instance)) ||
                    (lagrangian.switching != NULL && lagrangian.switching->is_due(instance));
  *terminateSimulation = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  struct Instance *instance = enter(c, FUNCTION_SET_TIME, __func__);
  if (instance == NULL) return fmi2Error;
  if (!isfinite(time))
    return fmi2_status(log_error(instance, "%s: the time is %g; expected a finite number", __func__, time));
  instance->situation->time = time;
  return fmi2OK;
}

/* The instance where the function may be called with an array of states; NULL after logging where it may not. */
static struct Instance *enter_with_states(fmi2Component c, enum Function function, const char *name, const void *array,
                                          size_t count) {
  struct Instance *instance = enter(c, function, name);
  if (instance == NULL) return NULL;
  if (count != lagrangian.state_count) {
    log_error(instance, "%s: %zu elements; expected %zu, the number of states", name, count, lagrangian.state_count);
    return NULL;
  }
  return check_array(instance, array, count, name, "the array") ? instance : NULL;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
  struct Instance *instance = enter_with_states(c, FUNCTION_SET_CONTINUOUS_STATES, __func__, x, nx);
  if (instance == NULL) return fmi2Error;
  for (size_t i = 0; i < nx; i++)
    if (!isfinite(x[i]))
      return fmi2_status(log_error(instance, "%s: state %zu is %g; expected a finite number", __func__, i + 1, x[i]));
  if (nx > 0) memcpy(instance->state, x, nx * sizeof *x);
  return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx) {
  struct Instance *instance = enter_with_states(c, FUNCTION_GET_CONTINUOUS, __func__, derivatives, nx);
  if (instance == NULL) return fmi2Error;
  if (nx == 0) return fmi2OK;
  enum Status status = evaluate_situation(instance, instance->work);
  if (status == STATUS_DONE) memcpy(derivatives, instance->work, nx * sizeof *derivatives);
  return fmi2_status(status);
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  size_t count = indicator_count(lagrangian.switches);
  if (instance == NULL) return fmi2Error;
  if (ni != count)
    return fmi2_status(
        log_error(instance, "%s: %zu elements; expected %zu, the number of event indicators", __func__, ni, count));
  if (count == 0) return fmi2OK;
  if (!check_array(instance, eventIndicators, ni, __func__, "the array")) return fmi2Error;
  return lagrangian.switching->indicators(instance, eventIndicators) ? fmi2OK
                                                                     : fmi2_status(discard_for_singularity(instance));
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx) {
  struct Instance *instance = enter_with_states(c, FUNCTION_GET_CONTINUOUS, __func__, x, nx);
  if (instance == NULL) return fmi2Error;
  if (nx > 0) memcpy(x, instance->state, nx * sizeof *x);
  return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx) {
  struct Instance *instance = enter_with_states(c, FUNCTION_GET_NOMINALS, __func__, x_nominal, nx);
  if (instance == NULL) return fmi2Error;
  if (nx > 0) memcpy(x_nominal, lagrangian.nominal, nx * sizeof *x_nominal);
  return fmi2OK;
}
