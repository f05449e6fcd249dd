/* Values of variables of the types in use (sections 2.2.6 and 2.4.7). */
#include "fmi/life_cycle.h"
#include "fmi/values.h"
#include "fmi3/fmi3_component.h"
#include "fmi3/fmi3_references.h"

/* Returns the indices of scalars if the function may be called with these arrays; NULL after logging an error. */
static const unsigned *enter_with_values(fmi3Instance c, enum FunctionClass function, const char *name,
                                         const fmi3ValueReference vr[], size_t nvr, const void *values,
                                         size_t nValues) {
  if (enter(c, function, name) == NULL) return NULL;
  return expand_references(c, WORKSPACE_REFERENCES, vr, nvr, (struct ValueArray){values, nValues});
}

/* Turns fmi3Discard into an error in intermediate update mode, where it is not allowed (section 4.2.2). */
static fmi3Status status_in_mode(struct Instance *instance, enum Status status) {
  int32_t phase = instance->fmu_state->phase;
  bool is_inside = phase == PHASE_INTERMEDIATE_UPDATE || phase == PHASE_INPUT_REQUEST;
  if (status != STATUS_DISCARD || !is_inside) return status_of(status);
  instance->fmu_state->phase = PHASE_ERROR;
  return fmi3Error;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Float64 values[],
                          size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  return status_in_mode(c, values_get(c, references, nValues, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Float64 values[],
                          size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_SET_REAL, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  return status_in_mode(c, values_set(c, references, nValues, values, TYPE_REAL));
}

/* Statistics have the type Int64. */
fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Int64 values[], size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  return status_of(values_get_counts(c, references, nValues, values));
}

/* Integer parameters have the type Int32. */
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Int32 values[], size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  for (size_t i = 0; i < nValues; i++)
    if (references[i] < lagrangian.variable_count && lagrangian.variables[references[i]].kind == VARIABLE_STATISTIC)
      return status_of(reject_call(c, "'%s' is of the type Int64", lagrangian.variables[references[i]].name));
  return status_of(values_get_whole(c, references, nValues, values, TYPE_INTEGER));
}

fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Int32 values[],
                        size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_SET_DISCRETE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  return status_of(values_set(c, references, nValues, values, TYPE_INTEGER));
}

fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Boolean values[],
                          size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_GET_VALUE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  int *whole = reserve_workspace(c, WORKSPACE_VALUES, nValues, sizeof *whole);
  if (whole == NULL) return fmi3Error;
  enum Status status = values_get_whole(c, references, nValues, whole, TYPE_BOOLEAN);
  for (size_t i = 0; i < nValues && status == STATUS_DONE; i++) values[i] = whole[i] != 0;
  return status_of(status);
}

fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Boolean values[],
                          size_t nValues) {
  const unsigned *references = enter_with_values(c, FUNCTION_SET_DISCRETE, __func__, vr, nvr, values, nValues);
  if (references == NULL) return fmi3Error;
  int *whole = reserve_workspace(c, WORKSPACE_VALUES, nValues, sizeof *whole);
  if (whole == NULL) return fmi3Error;
  for (size_t i = 0; i < nValues; i++) whole[i] = values[i];
  return status_of(values_set(c, references, nValues, whole, TYPE_BOOLEAN));
}
