/* Getting and setting variables (section 2.1.7). */
#include <math.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"

/*
 * In initialization mode the standard allows outputs and initial unknowns alone to be read. Importers such as libcosim
 * read all variables then; they get the values with a warning.
 */
static fmi2Status check_readable(struct Instance *instance, const struct ScalarVariable *variable) {
  if (instance->situation->mode != MODE_INITIALIZATION || variable->is_output || variable->kind == VARIABLE_DERIVATIVE)
    return fmi2OK;
  log_message(instance, fmi2Warning,
              "'%s' was read in initialization mode; expected only outputs and InitialUnknowns to be read then",
              variable->name);
  return fmi2Warning;
}

static fmi2Status worse(fmi2Status first, fmi2Status second) {
  return first > second ? first : second;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_VALUE, "fmi2GetReal") ||
      !check_array(instance, vr, nvr, "fmi2GetReal", "vr") ||
      !check_array(instance, value, nvr, "fmi2GetReal", "value"))
    return fmi2Error;
  fmi2Status status = fmi2OK;
  for (size_t i = 0; i < nvr; i++) {
    const struct ScalarVariable *variable = check_reference(instance, vr[i], false, "fmi2GetReal");
    if (variable == NULL) return fmi2Error;
    if (status == fmi2OK) status = check_readable(instance, variable); /* one warning is enough */
    status = worse(status, evaluate_variable(instance, variable, &value[i]));
  }
  return status;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[]) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_VALUE, "fmi2GetInteger") ||
      !check_array(instance, vr, nvr, "fmi2GetInteger", "vr") ||
      !check_array(instance, value, nvr, "fmi2GetInteger", "value"))
    return fmi2Error;
  fmi2Status status = fmi2OK;
  for (size_t i = 0; i < nvr; i++) {
    const struct ScalarVariable *variable = check_reference(instance, vr[i], true, "fmi2GetInteger");
    if (variable == NULL) return fmi2Error;
    if (status == fmi2OK) status = check_readable(instance, variable);
    value[i] = instance->situation->statistics[variable->index];
  }
  return status;
}

/* Whether this kind of variable may be set now (section 4.2.4, notes on fmi2SetReal). */
static bool is_settable(const struct Instance *instance, const struct ScalarVariable *variable) {
  bool before = instance->situation->mode == MODE_INSTANTIATED || instance->situation->mode == MODE_INITIALIZATION;
  switch (variable->kind) {
  case VARIABLE_INPUT: return true;
  case VARIABLE_PARAMETER: return instance->situation->mode != MODE_CONTINUOUS_TIME;
  case VARIABLE_STATE: return before;
  default: return false;
  }
}

static fmi2Status check_value(struct Instance *instance, fmi2ValueReference reference, double value) {
  const struct ScalarVariable *variable = check_reference(instance, reference, false, "fmi2SetReal");
  if (variable == NULL) return fmi2Error;
  if (!is_settable(instance, variable))
    return log_error(instance, "fmi2SetReal: '%s' cannot be set in the state '%s'", variable->name,
                     life_cycle_mode_name((enum Mode)instance->situation->mode));
  if (!isfinite(value))
    return log_error(instance, "fmi2SetReal: the value for '%s' is %g; expected a finite number", variable->name,
                     value);
  if (value < variable->minimum || value > variable->maximum)
    return log_error(instance, "fmi2SetReal: %g for '%s' is outside its range from %g to %g", value, variable->name,
                     variable->minimum, variable->maximum);
  return fmi2OK;
}

/* A value ends what fmi2SetRealInputDerivatives said for an earlier step; what it said for the step to come holds. */
static void end_polynomial(struct Instance *instance, size_t input) {
  if (instance->situation->input_derivatives_set) return;
  for (size_t order = 0; order < INPUT_ORDER; order++)
    instance->input_derivatives[order * lagrangian.input_count + input] = 0.0;
}

static void set_value(struct Instance *instance, const struct ScalarVariable *variable, double value) {
  if (variable->kind == VARIABLE_INPUT) end_polynomial(instance, variable->index);
  double *target = variable->kind == VARIABLE_INPUT   ? &instance->input[variable->index]
                   : variable->kind == VARIABLE_STATE ? &instance->state[variable->index]
                                                      : &instance->parameter[variable->index];
  if (*target == value) return;
  *target = value;
  instance->situation->changed = 1;
  if (variable->kind == VARIABLE_PARAMETER) instance->prepared_is_stale = true;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SET_REAL, "fmi2SetReal") || !check_array(instance, vr, nvr, "fmi2SetReal", "vr") ||
      !check_array(instance, value, nvr, "fmi2SetReal", "value"))
    return fmi2Error;
  /* All values are checked before the first is set. */
  for (size_t i = 0; i < nvr; i++)
    if (check_value(instance, vr[i], value[i]) != fmi2OK) return fmi2Error;
  for (size_t i = 0; i < nvr; i++) set_value(instance, &lagrangian.variables[vr[i]], value[i]);
  return fmi2OK;
}

/* There are no variables to set or to get of the types Integer (to set), Boolean and String. */
static fmi2Status no_variable(fmi2Component c, enum Function function, const char *name, size_t nvr) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, function, name)) return fmi2Error;
  if (nvr == 0) return fmi2OK;
  return log_error(instance, "%s: the FMU has no variable for this function", name);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[]) {
  (void)vr;
  (void)value;
  return no_variable(c, FUNCTION_GET_VALUE, "fmi2GetBoolean", nvr);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
  (void)vr;
  (void)value;
  return no_variable(c, FUNCTION_GET_VALUE, "fmi2GetString", nvr);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[]) {
  (void)vr;
  (void)value;
  return no_variable(c, FUNCTION_SET_DISCRETE, "fmi2SetInteger", nvr);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[]) {
  (void)vr;
  (void)value;
  return no_variable(c, FUNCTION_SET_DISCRETE, "fmi2SetBoolean", nvr);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
  (void)vr;
  (void)value;
  return no_variable(c, FUNCTION_SET_DISCRETE, "fmi2SetString", nvr);
}
