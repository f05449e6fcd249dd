/* States in which functions may be called: FMI 2.0.4, sections 3.2.3 and 4.2.4; FMI 3.0, sections 2.3, 3.2 and 4.2. */
#pragma once

#include "instance/instance.h"

/* Classes of functions that may be called in the same states. */
enum FunctionClass {
  FUNCTION_SET_DEBUG_LOGGING,
  FUNCTION_SET_UP,
  FUNCTION_EXIT_INITIALIZATION_MODE,
  FUNCTION_TERMINATE,
  FUNCTION_RESET,
  FUNCTION_GET_VALUE,
  FUNCTION_SET_REAL,
  FUNCTION_SET_DISCRETE,
  FUNCTION_GET_DEPENDENCIES,
  FUNCTION_FMU_STATE,
  FUNCTION_GET_PARTIAL_DERIVATIVE,
  FUNCTION_ENTER_EVENT_MODE,
  FUNCTION_ENTER_EVENT_MODE_OF_STEPS, /* in co-simulation too */
  FUNCTION_UPDATE_DISCRETE_STATES,
  FUNCTION_ENTER_CONTINUOUS_TIME_MODE,
  FUNCTION_ENTER_STEP_MODE,
  FUNCTION_COMPLETED_INTEGRATOR_STEP,
  FUNCTION_SET_TIME,
  FUNCTION_SET_CONTINUOUS_STATES,
  FUNCTION_GET_CONTINUOUS,
  FUNCTION_GET_NOMINALS,
  FUNCTION_GET_COUNT,
  FUNCTION_SET_INPUT_DERIVATIVES,
  FUNCTION_GET_OUTPUT_DERIVATIVES,
  FUNCTION_DO_STEP,
  FUNCTION_GET_STATUS,
  FUNCTION_NEVER, /* for capabilities that no FMU declares */
  FUNCTION_COUNT
};

/*
 * Returns the instance of a component, which is its first member, if the function may be called now. name: of the
 * function, for messages. Returns NULL after logging an error if it may not, or if component is NULL.
 */
struct Instance *enter(void *component, enum FunctionClass function, const char *name);
