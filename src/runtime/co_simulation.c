/* FMI for Co-Simulation (section 4.2): communication steps. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"
#include "solver.h"

bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative) {
  struct Point point = solver_point(instance, time, state);
  instance->situation->statistics[STATISTIC_DERIVATIVES]++;
  return evaluate_derivatives(instance, &point, derivative);
}

struct Point solver_point(struct Instance *instance, double time, const double *state) {
  struct Point point = evaluate_point(instance);
  point.time = time;
  point.state = state;
  if (instance->situation->input_derivatives_set) {
    evaluate_inputs(instance, time, instance->work);
    point.input = instance->work;
  }
  return point;
}

/* The polynomials of the inputs, continued from the end of the step. */
static void advance_inputs(struct Instance *instance, double end) {
  if (!instance->situation->input_derivatives_set) return;
  size_t n = lagrangian.input_count;
  for (size_t i = 0; i < n; i++) {
    double coefficient[INPUT_ORDER + 1], *derivative = instance->input_derivatives + i;
    expand_input(instance, i, end, coefficient);
    instance->input[i] = coefficient[0];
    derivative[0] = coefficient[1];
    derivative[n] = 2.0 * coefficient[2];
  }
  instance->situation->changed = 1;
}

/* What is wrong with the arguments of fmi2DoStep; fmi2OK where nothing is. */
static fmi2Status check_step(struct Instance *instance, double time, double step) {
  const struct Situation *situation = instance->situation;
  if (!isfinite(time) || !isfinite(step) || step <= 0.0)
    return log_error(instance, "fmi2DoStep: step %g at time %g; expected a finite step larger than 0", step, time);
  double rounding = 8 * DBL_EPSILON * fabs(time) + 1e-6 * step;
  if (fabs(time - situation->time) > rounding)
    return log_error(instance, "fmi2DoStep: currentCommunicationPoint is %.15g; expected %.15g, where the instance is",
                     time, situation->time);
  if (time + step <= time)
    return log_error(instance, "fmi2DoStep: step %g does not advance the time %g; expected a larger one", step, time);
  if (!isfinite(time + step))
    return log_error(instance, "fmi2DoStep: step %g from time %g ends beyond all numbers; expected a shorter one", step,
                     time);
  if (situation->stop_time_defined && time + step > situation->stop_time + rounding)
    return log_error(instance, "fmi2DoStep: the step ends at %.15g; expected none past stopTime %.15g", time + step,
                     situation->stop_time);
  return fmi2OK;
}

static enum StepResult advance(struct Instance *instance, double length, double *reached) {
  *reached = instance->situation->time + length;
  if (lagrangian.solver == NULL) return STEP_DONE;
  if (instance->solver_memory == NULL && !lagrangian.solver->create(instance)) return STEP_FAILED;
  return lagrangian.solver->step(instance, length, reached);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
  struct Instance *instance = c;
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_DO_STEP, "fmi2DoStep") ||
      check_step(instance, currentCommunicationPoint, communicationStepSize) != fmi2OK)
    return fmi2Error;
  if (evaluate_prepare(instance) != fmi2OK)
    return log_error(instance, "fmi2DoStep: the parameters leave no acceleration at time %g",
                     currentCommunicationPoint);
  struct Situation *situation = instance->situation;
  situation->time = currentCommunicationPoint;
  if (!situation->input_derivatives_set)
    memset(instance->input_derivatives, 0, INPUT_ORDER * lagrangian.input_count * sizeof(double));
  double reached = currentCommunicationPoint;
  enum StepResult result = advance(instance, communicationStepSize, &reached);
  if (result == STEP_FAILED) return log_error(instance, "fmi2DoStep: the step from time %g failed", situation->time);
  advance_inputs(instance, reached);
  situation->input_derivatives_set = 0;
  situation->time = reached;
  if (result == STEP_DONE) return fmi2OK;
  situation->mode = MODE_STEP_FAILED;
  return fmi2Discard;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  check_call(instance, FUNCTION_CANCEL_STEP, "fmi2CancelStep");
  return fmi2Error;
}

/* fmi2Discard for what the FMU does not know: a step is never pending. */
static fmi2Status unknown_status(struct Instance *instance, const char *name) {
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_STATUS, name)) return fmi2Error;
  log_message(instance, fmi2Discard, "%s: no step is pending, so there is no such status", name);
  return fmi2Discard;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value) {
  (void)s;
  (void)value;
  return unknown_status(c, "fmi2GetStatus");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
  struct Instance *instance = c;
  if (instance == NULL || s != fmi2LastSuccessfulTime) return unknown_status(c, "fmi2GetRealStatus");
  if (!check_call(instance, FUNCTION_GET_STATUS, "fmi2GetRealStatus") ||
      !check_array(instance, value, 1, "fmi2GetRealStatus", "value"))
    return fmi2Error;
  *value = instance->situation->time;
  return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value) {
  (void)s;
  (void)value;
  return unknown_status(c, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
  struct Instance *instance = c;
  if (instance == NULL || s != fmi2Terminated) return unknown_status(c, "fmi2GetBooleanStatus");
  if (!check_call(instance, FUNCTION_GET_STATUS, "fmi2GetBooleanStatus") ||
      !check_array(instance, value, 1, "fmi2GetBooleanStatus", "value"))
    return fmi2Error;
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value) {
  (void)s;
  (void)value;
  return unknown_status(c, "fmi2GetStringStatus");
}
