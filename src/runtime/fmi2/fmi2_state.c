/* Saving, restoring and serializing the state of an instance (section 2.1.8). */
#include "fmi/saved_state.h"
#include "fmi2/fmi2_life_cycle.h"

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(saved_state_get(instance, FMUstate, __func__));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(saved_state_set(instance, FMUstate, __func__));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(saved_state_free(instance, FMUstate));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(saved_state_size(instance, FMUstate, size, __func__));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL) return fmi2Error;
  return fmi2_status(saved_state_write(instance, FMUstate, serializedState, size, __func__));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL) return fmi2Error;
  return fmi2_status(saved_state_read(instance, serializedState, size, FMUstate, __func__));
}
