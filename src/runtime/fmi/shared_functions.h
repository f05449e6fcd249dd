/*
 * The FMI functions that differ between versions only in their names. Each version includes this once, after its struct
 * FmiComponent and three macros: FMI(name) puts the version's prefix before a name. GetNominalsOfContinuousStates may
 * be called in the class NOMINALS. QUIET_CATEGORIES are logged without debug logging.
 */
#ifndef SHARED_FUNCTIONS_H
#define SHARED_FUNCTIONS_H

#include "fmi/check.h"
#include "fmi/life_cycle.h"
#include "fmi/log_categories.h"
#include "fmi/model_exchange.h"
#include "fmi/saved_state.h"
#include "fmi/simulation.h"

/* --- Life ---------------------------------------------------------------------------------------------------------- */

FMI(Status) FMI(SetDebugLogging)(void *c, FMI(Boolean) loggingOn, size_t nCategories, const char *const names[]) {
  struct FmiComponent *component = c;
  struct Instance *instance = enter(c, FUNCTION_SET_DEBUG_LOGGING, __func__);
  unsigned chosen = 0;
  if (instance == NULL || !log_choose(instance, names, nCategories, &chosen)) return FMI(Error);
  if (nCategories == 0) component->categories = loggingOn ? ALL_CATEGORIES : QUIET_CATEGORIES;
  else component->categories = loggingOn ? chosen : component->categories & ~chosen;
  instance->log = log_of(component);
  return FMI(OK);
}

FMI(Status) FMI(Terminate)(void *c) {
  struct Instance *instance = enter(c, FUNCTION_TERMINATE, __func__);
  if (instance == NULL) return FMI(Error);
  simulation_terminate(instance);
  return FMI(OK);
}

FMI(Status) FMI(Reset)(void *c) {
  struct Instance *instance = enter(c, FUNCTION_RESET, __func__);
  if (instance == NULL) return FMI(Error);
  instance_reset(instance);
  return FMI(OK);
}

FMI(Status) FMI(EnterContinuousTimeMode)(void *c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_CONTINUOUS_TIME_MODE, __func__);
  if (instance == NULL) return FMI(Error);
  return status_of(exchange_leave_event_mode(instance));
}

/* --- States, saved and restored ------------------------------------------------------------------------------------ */

FMI(Status) FMI(GetFMUState)(void *c, void **state) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_get(instance, state));
}

FMI(Status) FMI(SetFMUState)(void *c, void *state) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_set(instance, state));
}

FMI(Status) FMI(FreeFMUState)(void *c, void **state) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_free(instance, state));
}

FMI(Status) FMI(SerializedFMUStateSize)(void *c, void *state, size_t *size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_size(instance, state, size));
}

FMI(Status) FMI(SerializeFMUState)(void *c, void *state, FMI(Byte) bytes[], size_t size) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_write(instance, state, bytes, size));
}

FMI(Status) FMI(DeserializeFMUState)(void *c, const FMI(Byte) bytes[], size_t size, void **state) {
  struct Instance *instance = enter(c, FUNCTION_FMU_STATE, __func__);
  return instance == NULL ? FMI(Error) : status_of(saved_state_read(instance, bytes, size, state));
}

/* --- Model exchange ------------------------------------------------------------------------------------------------ */

FMI(Status)
FMI(CompletedIntegratorStep)
(void *c, FMI(Boolean) noSetFMUStatePriorToCurrentPoint, FMI(Boolean) * enterEventMode,
 FMI(Boolean) * terminateSimulation) {
  struct Instance *instance = enter(c, FUNCTION_COMPLETED_INTEGRATOR_STEP, __func__);
  (void)noSetFMUStatePriorToCurrentPoint;
  if (instance == NULL || !check_array(instance, enterEventMode, 1, "enterEventMode") ||
      !check_array(instance, terminateSimulation, 1, "terminateSimulation"))
    return FMI(Error);
  bool needs_event = false;
  enum Status status = exchange_complete_step(instance, &needs_event);
  *enterEventMode = needs_event;
  *terminateSimulation = FMI(False);
  return status_of(status);
}

FMI(Status) FMI(SetTime)(void *c, double time) {
  struct Instance *instance = enter(c, FUNCTION_SET_TIME, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_set_time(instance, time));
}

FMI(Status) FMI(SetContinuousStates)(void *c, const double states[], size_t count) {
  struct Instance *instance = enter(c, FUNCTION_SET_CONTINUOUS_STATES, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_set_states(instance, states, count));
}

FMI(Status) FMI(GetContinuousStates)(void *c, double states[], size_t count) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_get_states(instance, states, count));
}

FMI(Status) FMI(GetContinuousStateDerivatives)(void *c, double derivatives[], size_t count) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_get_derivatives(instance, derivatives, count));
}

FMI(Status) FMI(GetNominalsOfContinuousStates)(void *c, double nominals[], size_t count) {
  struct Instance *instance = enter(c, NOMINALS, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_get_nominals(instance, nominals, count));
}

FMI(Status) FMI(GetEventIndicators)(void *c, double indicators[], size_t count) {
  struct Instance *instance = enter(c, FUNCTION_GET_CONTINUOUS, __func__);
  return instance == NULL ? FMI(Error) : status_of(exchange_get_event_indicators(instance, indicators, count));
}

#endif
