/* Directional derivatives (section 2.1.9) and derivatives of inputs (section 4.2.1). */
#include <math.h>
#include <string.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"

/* A direction and what follows from it; the arrays are parts of instance->work. */
struct Direction {
  struct Seed seed;
  double *state, *input, *parameter;
  double *derivative, *derivative_along;
};

static struct Direction direction_create(struct Instance *instance) {
  struct Direction direction = {.derivative = instance->work};
  direction.derivative_along = direction.derivative + lagrangian.state_count;
  direction.state = direction.derivative_along + lagrangian.state_count;
  direction.input = direction.state + lagrangian.state_count;
  direction.parameter = direction.input + lagrangian.input_count;
  size_t count = 3 * lagrangian.state_count + lagrangian.input_count + lagrangian.parameter_count;
  memset(instance->work, 0, count * sizeof *instance->work);
  direction.seed = (struct Seed){.state = direction.state, .input = direction.input, .parameter = direction.parameter};
  return direction;
}

/* Fills derivative and derivative_along at the point. */
static fmi2Status follow(struct Instance *instance, const struct Point *point, struct Direction *direction) {
  if (lagrangian.derivatives == NULL) return fmi2OK;
  if (!evaluate_derivatives(instance, point, direction->derivative)) {
    log_singularity(instance, fmi2Discard, point->time);
    return fmi2Discard;
  }
  instance->singular = lagrangian.directional(point, &direction->seed, direction->derivative_along);
  return instance->singular == 0 ? fmi2OK : fmi2Discard;
}

static fmi2Status set_seed(struct Instance *instance, struct Direction *direction,
                           const struct ScalarVariable *variable, double value) {
  if (!isfinite(value))
    return log_error(instance, "fmi2GetDirectionalDerivative: the seed of '%s' is %g; expected a finite number",
                     variable->name, value);
  switch (variable->kind) {
  case VARIABLE_TIME: direction->seed.time = value; return fmi2OK;
  case VARIABLE_STATE: direction->state[variable->index] = value; return fmi2OK;
  case VARIABLE_INPUT: direction->input[variable->index] = value; return fmi2OK;
  case VARIABLE_PARAMETER: direction->parameter[variable->index] = value; return fmi2OK;
  default:
    return log_error(instance,
                     "fmi2GetDirectionalDerivative: '%s' is no known; expected a state, an input or a parameter",
                     variable->name);
  }
}

static fmi2Status check_unknown(struct Instance *instance, const struct ScalarVariable *variable) {
  if (variable->is_output || variable->kind == VARIABLE_DERIVATIVE) return fmi2OK;
  return log_error(instance,
                   "fmi2GetDirectionalDerivative: '%s' is no unknown; expected an output or a state derivative",
                   variable->name);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
  static const char *const name = "fmi2GetDirectionalDerivative";
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_DIRECTIONAL_DERIVATIVE, name) ||
      !check_array(instance, vUnknown_ref, nUnknown, name, "vUnknown_ref") ||
      !check_array(instance, vKnown_ref, nKnown, name, "vKnown_ref") ||
      !check_array(instance, dvKnown, nKnown, name, "dvKnown") ||
      !check_array(instance, dvUnknown, nUnknown, name, "dvUnknown"))
    return fmi2Error;
  struct Direction direction = direction_create(instance);
  for (size_t i = 0; i < nKnown; i++) {
    const struct ScalarVariable *variable = check_reference(instance, vKnown_ref[i], false, name);
    if (variable == NULL || set_seed(instance, &direction, variable, dvKnown[i]) != fmi2OK) return fmi2Error;
  }
  for (size_t i = 0; i < nUnknown; i++) {
    const struct ScalarVariable *variable = check_reference(instance, vUnknown_ref[i], false, name);
    if (variable == NULL || check_unknown(instance, variable) != fmi2OK) return fmi2Error;
  }
  fmi2Status status = evaluate_prepare(instance);
  struct Point point = evaluate_point(instance);
  if (status == fmi2OK) status = follow(instance, &point, &direction);
  for (size_t i = 0; i < nUnknown && status == fmi2OK; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[vUnknown_ref[i]];
    double value = evaluate_along(variable, &point, &direction.seed, direction.derivative, direction.derivative_along);
    if (isfinite(value)) dvUnknown[i] = value;
    else {
      log_message(instance, fmi2Discard, "%s: the derivative of '%s' is not finite here", name, variable->name);
      status = fmi2Discard;
    }
  }
  return status;
}

static fmi2Status check_input_derivative(struct Instance *instance, fmi2ValueReference reference, int order,
                                         double value) {
  static const char *const name = "fmi2SetRealInputDerivatives";
  const struct ScalarVariable *variable = check_reference(instance, reference, false, name);
  if (variable == NULL) return fmi2Error;
  if (variable->kind != VARIABLE_INPUT) return log_error(instance, "%s: '%s' is no input", name, variable->name);
  if (order < 1 || order > INPUT_ORDER)
    return log_error(instance, "%s: the order %d for '%s' is out of range; expected 1 to %d", name, order,
                     variable->name, INPUT_ORDER);
  if (!isfinite(value))
    return log_error(instance, "%s: the value for '%s' is %g; expected a finite number", name, variable->name, value);
  return fmi2OK;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
  static const char *const name = "fmi2SetRealInputDerivatives";
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SET_INPUT_DERIVATIVES, name) || !check_array(instance, vr, nvr, name, "vr") ||
      !check_array(instance, order, nvr, name, "order") || !check_array(instance, value, nvr, name, "value"))
    return fmi2Error;
  for (size_t i = 0; i < nvr; i++)
    if (check_input_derivative(instance, vr[i], order[i], value[i]) != fmi2OK) return fmi2Error;
  size_t inputs = lagrangian.input_count;
  if (!instance->situation->input_derivatives_set)
    memset(instance->input_derivatives, 0, INPUT_ORDER * inputs * sizeof *instance->input_derivatives);
  for (size_t i = 0; i < nvr; i++)
    instance->input_derivatives[(size_t)(order[i] - 1) * inputs + lagrangian.variables[vr[i]].index] = value[i];
  instance->situation->input_derivatives_set = 1;
  instance->situation->changed = 1;
  return fmi2OK;
}

fmi2Status derivatives_in_time(struct Instance *instance, const fmi2ValueReference *vr, size_t nvr, double *value) {
  struct Point point = evaluate_point(instance);
  struct Direction direction = direction_create(instance);
  direction.seed.time = 1.0;
  direction.seed.input = instance->input_derivatives;
  if (lagrangian.derivatives != NULL && !evaluate_derivatives(instance, &point, direction.state)) {
    log_singularity(instance, fmi2Discard, point.time);
    return fmi2Discard;
  }
  fmi2Status status = follow(instance, &point, &direction);
  for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[vr[i]];
    double derivative =
        evaluate_along(variable, &point, &direction.seed, direction.derivative, direction.derivative_along);
    if (isfinite(derivative)) value[i] = derivative;
    else {
      log_message(instance, fmi2Discard, "fmi2GetRealOutputDerivatives: the derivative of '%s' is not finite here",
                  variable->name);
      status = fmi2Discard;
    }
  }
  return status;
}
