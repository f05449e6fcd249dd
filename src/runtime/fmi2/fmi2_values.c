/* Values of variables, and their derivatives (sections 2.1.7, 2.1.9 and 4.2.1). */
#include "fmi/check.h"
#include "fmi/derivatives.h"
#include "fmi/life_cycle.h"
#include "fmi/values.h"
#include "fmi2/fmi2_component.h"

/* Returns the instance if the function may be called with these arrays; NULL after logging an error. */
static struct Instance *enter_with_values(fmi2Component c, enum FunctionClass function, const char *name,
                                          const fmi2ValueReference vr[], size_t nvr, const void *value) {
  struct Instance *instance = enter(c, function, name);
  bool are_right =
      instance != NULL && check_array(instance, vr, nvr, "vr") && check_array(instance, value, nvr, "value");
  return are_right ? instance : NULL;
}

/* Turns fmi2Discard into an error, for functions that may not discard (section 2.1.3). */
static fmi2Status status_without_discard(struct Instance *instance, enum Status status) {
  if (status != STATUS_DISCARD) return status_of(status);
  instance->fmu_state->phase = PHASE_ERROR;
  return fmi2Error;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  enum Status status = values_get(instance, vr, nvr, value);
  return instance->kind == KIND_MODEL_EXCHANGE ? status_of(status) : status_without_discard(instance, status);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  return status_of(values_get_whole(instance, vr, nvr, value, TYPE_INTEGER));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_SET_REAL, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  return status_of(values_set(instance, vr, nvr, value, TYPE_REAL));
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  return status_of(values_get_whole(instance, vr, nvr, value, TYPE_BOOLEAN));
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_SET_DISCRETE, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  return status_of(values_set(instance, vr, nvr, value, TYPE_INTEGER));
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_SET_DISCRETE, __func__, vr, nvr, value);
  if (instance == NULL) return fmi2Error;
  return status_of(values_set(instance, vr, nvr, value, TYPE_BOOLEAN));
}

/* There are no variables of the type String. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
  (void)vr;
  (void)value;
  return status_of(values_none(c, FUNCTION_GET_VALUE, nvr, __func__));
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
  (void)vr;
  (void)value;
  return status_of(values_none(c, FUNCTION_SET_DISCRETE, nvr, __func__));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
  struct Instance *instance = enter(c, FUNCTION_GET_PARTIAL_DERIVATIVE, __func__);
  if (instance == NULL || !check_array(instance, vUnknown_ref, nUnknown, "vUnknown_ref") ||
      !check_array(instance, vKnown_ref, nKnown, "vKnown_ref") || !check_array(instance, dvKnown, nKnown, "dvKnown") ||
      !check_array(instance, dvUnknown, nUnknown, "dvUnknown"))
    return fmi2Error;
  return status_without_discard(
      instance, directional_derivative(instance, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_SET_INPUT_DERIVATIVES, __func__, vr, nvr, value);
  if (instance == NULL || !check_array(instance, order, nvr, "order")) return fmi2Error;
  return status_of(values_set_input_derivatives(instance, vr, nvr, order, value));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
  struct Instance *instance = enter_with_values(c, FUNCTION_GET_OUTPUT_DERIVATIVES, __func__, vr, nvr, value);
  if (instance == NULL || !check_array(instance, order, nvr, "order")) return fmi2Error;
  return status_without_discard(instance, output_derivatives(instance, vr, nvr, order, value));
}
