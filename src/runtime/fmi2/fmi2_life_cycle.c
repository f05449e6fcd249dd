#include "fmi2_life_cycle.h"

#define IN(mode) (1u << (mode))

enum {
  BEFORE = IN(MODE_INSTANTIATED) | IN(MODE_INITIALIZATION),
  AFTER = IN(MODE_TERMINATED) | IN(MODE_ERROR),
  EXCHANGE = IN(MODE_EVENT) | IN(MODE_CONTINUOUS_TIME),
  STEPS = IN(MODE_STEP_COMPLETE) | IN(MODE_STEP_FAILED),
  READABLE = IN(MODE_INITIALIZATION) | EXCHANGE | STEPS | AFTER,
  ALL = BEFORE | EXCHANGE | STEPS | AFTER,
  FOR_EXCHANGE = 1,
  FOR_STEPS = 2,
  FOR_BOTH = 3,
};

/* The modes of one type are never reached by instances of the other, so that one column serves both. */
static const struct {
  unsigned types, modes;
} table[FUNCTION_COUNT] = {
    [FUNCTION_SET_DEBUG_LOGGING] = {FOR_BOTH, ALL},
    [FUNCTION_SETUP_EXPERIMENT] = {FOR_BOTH, IN(MODE_INSTANTIATED)},
    [FUNCTION_ENTER_INITIALIZATION_MODE] = {FOR_BOTH, IN(MODE_INSTANTIATED)},
    [FUNCTION_EXIT_INITIALIZATION_MODE] = {FOR_BOTH, IN(MODE_INITIALIZATION)},
    [FUNCTION_TERMINATE] = {FOR_BOTH, EXCHANGE | STEPS},
    [FUNCTION_RESET] = {FOR_BOTH, ALL},
    [FUNCTION_GET_VALUE] = {FOR_BOTH, READABLE},
    [FUNCTION_SET_REAL] = {FOR_BOTH, BEFORE | EXCHANGE | IN(MODE_STEP_COMPLETE)},
    [FUNCTION_SET_DISCRETE] = {FOR_BOTH, BEFORE | IN(MODE_EVENT) | IN(MODE_STEP_COMPLETE)},
    [FUNCTION_FMU_STATE] = {FOR_BOTH, ALL},
    [FUNCTION_GET_DIRECTIONAL_DERIVATIVE] = {FOR_BOTH, READABLE},
    [FUNCTION_ENTER_EVENT_MODE] = {FOR_EXCHANGE, EXCHANGE},
    [FUNCTION_NEW_DISCRETE_STATES] = {FOR_EXCHANGE, IN(MODE_EVENT)},
    [FUNCTION_ENTER_CONTINUOUS_TIME_MODE] = {FOR_EXCHANGE, IN(MODE_EVENT)},
    [FUNCTION_COMPLETED_INTEGRATOR_STEP] = {FOR_EXCHANGE, IN(MODE_CONTINUOUS_TIME)},
    [FUNCTION_SET_TIME] = {FOR_EXCHANGE, EXCHANGE},
    [FUNCTION_SET_CONTINUOUS_STATES] = {FOR_EXCHANGE, IN(MODE_CONTINUOUS_TIME)},
    [FUNCTION_GET_CONTINUOUS] = {FOR_EXCHANGE, IN(MODE_INITIALIZATION) | EXCHANGE | AFTER},
    [FUNCTION_GET_NOMINALS] = {FOR_EXCHANGE, IN(MODE_INSTANTIATED) | EXCHANGE | AFTER},
    [FUNCTION_SET_INPUT_DERIVATIVES] = {FOR_STEPS, BEFORE | IN(MODE_STEP_COMPLETE)},
    [FUNCTION_GET_OUTPUT_DERIVATIVES] = {FOR_STEPS, STEPS | AFTER},
    [FUNCTION_DO_STEP] = {FOR_STEPS, IN(MODE_STEP_COMPLETE)},
    /* A step is never pending. */
    [FUNCTION_CANCEL_STEP] = {FOR_STEPS, 0},
    [FUNCTION_GET_STATUS] = {FOR_STEPS, STEPS | IN(MODE_TERMINATED)},
};

struct Instance *enter(fmi2Component c, enum Function function, const char *name) {
  struct Component *component = c;
  if (component == NULL) return NULL;
  struct Instance *instance = &component->instance;
  bool exchanges = instance->kind == KIND_MODEL_EXCHANGE;
  unsigned type = exchanges ? FOR_EXCHANGE : FOR_STEPS;
  if ((table[function].types & type) != 0 && (table[function].modes & IN(instance->situation->mode)) != 0)
    return instance;
  log_error(instance, "%s is not allowed in the state '%s' of an instance for %s", name, instance_mode_name(instance),
            exchanges ? "model exchange" : "co-simulation");
  return NULL;
}
