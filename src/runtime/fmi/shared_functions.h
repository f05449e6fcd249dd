/*
 * The FMI functions that differ between versions only in their names. Each version includes this once, after its struct
 * FmiComponent and three macros: FMI(name) puts the version's prefix before a name. GetNominalsOfContinuousStates may
 * be called in the class NOMINALS. QUIET_CATEGORIES are logged without debug logging.
 */
#pragma once

#include "fmi/check.h"
#include "fmi/life_cycle.h"
#include "fmi/log_categories.h"
#include "fmi/model_exchange.h"
#include "fmi/saved_state.h"
#include "fmi/simulation.h"

/* Defines a function of this class, with these parameters, that does no more than a call. */
#define FMI_FUNCTION(name, class, call, ...)                                                                           \
  FMI(Status) FMI(name)(__VA_ARGS__) {                                                                                 \
    struct Instance *instance = enter(c, class, __func__);                                                             \
    return instance == NULL ? FMI(Error) : status_of(call);                                                            \
  }

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

FMI_FUNCTION(EnterContinuousTimeMode, FUNCTION_ENTER_CONTINUOUS_TIME_MODE, exchange_leave_event_mode(instance), void *c)

/* --- States, saved and restored ------------------------------------------------------------------------------------ */

FMI_FUNCTION(GetFMUState, FUNCTION_FMU_STATE, saved_state_get(instance, state), void *c, void **state)
FMI_FUNCTION(SetFMUState, FUNCTION_FMU_STATE, saved_state_set(instance, state), void *c, void *state)
FMI_FUNCTION(FreeFMUState, FUNCTION_FMU_STATE, saved_state_free(instance, state), void *c, void **state)
FMI_FUNCTION(SerializedFMUStateSize, FUNCTION_FMU_STATE, saved_state_size(instance, state, size), void *c, void *state,
             size_t *size)
FMI_FUNCTION(SerializeFMUState, FUNCTION_FMU_STATE, saved_state_write(instance, state, bytes, size), void *c,
             void *state, FMI(Byte) bytes[], size_t size)
FMI_FUNCTION(DeserializeFMUState, FUNCTION_FMU_STATE, saved_state_read(instance, bytes, size, state), void *c,
             const FMI(Byte) bytes[], size_t size, void **state)

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

FMI_FUNCTION(SetTime, FUNCTION_SET_TIME, exchange_set_time(instance, time), void *c, double time)
FMI_FUNCTION(SetContinuousStates, FUNCTION_SET_CONTINUOUS_STATES, exchange_set_states(instance, states, count), void *c,
             const double states[], size_t count)
FMI_FUNCTION(GetContinuousStates, FUNCTION_GET_CONTINUOUS, exchange_get_states(instance, states, count), void *c,
             double states[], size_t count)
FMI_FUNCTION(GetContinuousStateDerivatives, FUNCTION_GET_CONTINUOUS,
             exchange_get_derivatives(instance, derivatives, count), void *c, double derivatives[], size_t count)
FMI_FUNCTION(GetNominalsOfContinuousStates, NOMINALS, exchange_get_nominals(instance, nominals, count), void *c,
             double nominals[], size_t count)
FMI_FUNCTION(GetEventIndicators, FUNCTION_GET_CONTINUOUS, exchange_get_event_indicators(instance, indicators, count),
             void *c, double indicators[], size_t count)
