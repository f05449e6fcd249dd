/* Saving, restoring and serializing the state of an instance (section 2.2.10). */
#include "fmi/saved_state.h"
#include "fmi3/fmi3_life_cycle.h"

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *FMUState) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi3Error : fmi3_status(saved_state_get(instance, FMUState, __func__));
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState FMUState) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi3Error : fmi3_status(saved_state_set(instance, FMUState, __func__));
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *FMUState) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi3Error : fmi3_status(saved_state_free(instance, FMUState));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState FMUState, size_t *size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? fmi3Error : fmi3_status(saved_state_size(instance, FMUState, size, __func__));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(saved_state_write(instance, FMUState, serializedState, size, __func__));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  if (instance == NULL) return fmi3Error;
  return fmi3_status(saved_state_read(instance, serializedState, size, FMUState, __func__));
}
