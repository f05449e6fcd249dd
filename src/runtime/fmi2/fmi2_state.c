/* Saving, restoring and serializing the state of an instance (section 2.1.8); an fmi2FMUstate is a snapshot. */
#include <string.h>

#include "check.h"
#include "fmi2_life_cycle.h"
#include "snapshot.h"

/* Gives the caller's state memory where it has none. */
static bool allocate(struct Instance *instance, fmi2FMUstate *state, const char *function) {
  if (*state == NULL) *state = instance->memory.allocate(1, snapshot_size());
  if (*state == NULL) log_error(instance, "%s: allocateMemory returned no memory", function);
  return *state != NULL;
}

/* Whether the bytes can be restored; logs an error where they cannot. */
static bool check_state(struct Instance *instance, const void *block, size_t size, const char *function) {
  const char *fault = snapshot_fault(instance, block, size);
  if (fault != NULL) log_error(instance, "%s: the bytes of the state cannot be used: %s", function, fault);
  return fault == NULL;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL || !check_array(instance, FMUstate, 1, __func__, "FMUstate") ||
      !allocate(instance, FMUstate, __func__))
    return fmi2Error;
  snapshot_take(instance, *FMUstate);
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL || !check_array(instance, FMUstate, 1, __func__, "FMUstate") ||
      !check_state(instance, FMUstate, snapshot_size(), __func__))
    return fmi2Error;
  snapshot_restore(instance, FMUstate);
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL) return fmi2Error;
  if (FMUstate == NULL || *FMUstate == NULL) return fmi2OK;
  instance->memory.free(*FMUstate);
  *FMUstate = NULL;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL || !check_array(instance, FMUstate, 1, __func__, "FMUstate") ||
      !check_array(instance, size, 1, __func__, "size"))
    return fmi2Error;
  *size = snapshot_size();
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL || !check_array(instance, FMUstate, 1, __func__, "FMUstate") ||
      !check_array(instance, serializedState, 1, __func__, "serializedState"))
    return fmi2Error;
  if (size < snapshot_size())
    return fmi2_status(log_error(instance, "%s: the size is %zu; expected %zu", __func__, size, snapshot_size()));
  memcpy(serializedState, FMUstate, snapshot_size());
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL || !check_array(instance, serializedState, size, __func__, "serializedState") ||
      !check_array(instance, FMUstate, 1, __func__, "FMUstate") ||
      !check_state(instance, serializedState, size, __func__) || !allocate(instance, FMUstate, __func__))
    return fmi2Error;
  memcpy(*FMUstate, serializedState, snapshot_size());
  return fmi2OK;
}
