/*
 * State machine of FMI. An instance is in one phase (fmu_state->phase):
 *
 *   instantiated -> initialization mode -> event mode <-> continuous-time mode -> terminated      model exchange
 *   instantiated -> initialization mode -> step complete or failed <-> event mode -> terminated   co-simulation
 *
 * Co-simulation has event mode in FMI 3.0, if the importer uses it, and intermediate update mode inside a step.
 * Each function belongs to a class, enum FunctionClass. permitted[] gives the kinds of instances and the phases in
 * which functions of a class may be called. Every function asks enter() first. A call in another phase is an error:
 * the instance goes to PHASE_ERROR, where it can be read, reset or freed.
 */
#include "fmi/life_cycle.h"

#define IN(phase) (1u << (phase))

/* Sets of phases. One set serves both kinds and all versions of FMI: phases of the others are never reached. */
enum {
  BEFORE = IN(PHASE_INSTANTIATED) | IN(PHASE_INITIALIZATION),
  AFTER = IN(PHASE_TERMINATED) | IN(PHASE_ERROR),
  EXCHANGE = IN(PHASE_EVENT) | IN(PHASE_CONTINUOUS_TIME),
  STEPS = IN(PHASE_STEP_COMPLETE) | IN(PHASE_STEP_FAILED),
  INTERMEDIATE = IN(PHASE_INTERMEDIATE_UPDATE),
  REQUEST = IN(PHASE_INPUT_REQUEST),
  READABLE = IN(PHASE_INITIALIZATION) | EXCHANGE | STEPS | AFTER,
  /* calls that would end or replace the simulation wait for the end of a step */
  BETWEEN_STEPS = BEFORE | EXCHANGE | STEPS | AFTER,
  NEVER = 0
};

/* Sets of kinds. */
enum {
  FOR_EXCHANGE = 1 << KIND_MODEL_EXCHANGE,
  FOR_STEPS = 1 << KIND_CO_SIMULATION,
  FOR_BOTH = FOR_EXCHANGE | FOR_STEPS
};

static const struct {
  unsigned kinds, phases;
} permitted[FUNCTION_COUNT] = {
    [FUNCTION_SET_DEBUG_LOGGING] = {FOR_BOTH, BETWEEN_STEPS | INTERMEDIATE | REQUEST},
    [FUNCTION_SET_UP] = {FOR_BOTH, IN(PHASE_INSTANTIATED)},
    [FUNCTION_EXIT_INITIALIZATION_MODE] = {FOR_BOTH, IN(PHASE_INITIALIZATION)},
    [FUNCTION_TERMINATE] = {FOR_BOTH, EXCHANGE | STEPS},
    [FUNCTION_RESET] = {FOR_BOTH, BETWEEN_STEPS},
    [FUNCTION_GET_VALUE] = {FOR_BOTH, READABLE | INTERMEDIATE},
    [FUNCTION_SET_REAL] = {FOR_BOTH, BEFORE | EXCHANGE | IN(PHASE_STEP_COMPLETE) | REQUEST},
    [FUNCTION_SET_DISCRETE] = {FOR_BOTH, BEFORE | IN(PHASE_EVENT) | IN(PHASE_STEP_COMPLETE)},
    [FUNCTION_GET_DEPENDENCIES] = {FOR_BOTH, BETWEEN_STEPS},
    [FUNCTION_FMU_STATE] = {FOR_BOTH, BETWEEN_STEPS},
    [FUNCTION_GET_PARTIAL_DERIVATIVE] = {FOR_BOTH, READABLE},
    [FUNCTION_ENTER_EVENT_MODE] = {FOR_EXCHANGE, EXCHANGE},
    [FUNCTION_ENTER_EVENT_MODE_OF_STEPS] = {FOR_BOTH, IN(PHASE_CONTINUOUS_TIME) | IN(PHASE_STEP_COMPLETE)},
    [FUNCTION_UPDATE_DISCRETE_STATES] = {FOR_BOTH, IN(PHASE_EVENT)},
    [FUNCTION_ENTER_CONTINUOUS_TIME_MODE] = {FOR_EXCHANGE, IN(PHASE_EVENT)},
    [FUNCTION_ENTER_STEP_MODE] = {FOR_STEPS, IN(PHASE_EVENT)},
    [FUNCTION_COMPLETED_INTEGRATOR_STEP] = {FOR_EXCHANGE, IN(PHASE_CONTINUOUS_TIME)},
    [FUNCTION_SET_TIME] = {FOR_EXCHANGE,
                           IN(PHASE_CONTINUOUS_TIME)}, /* FMI also allows event mode, without continuous time */
    [FUNCTION_SET_CONTINUOUS_STATES] = {FOR_EXCHANGE, IN(PHASE_CONTINUOUS_TIME)},
    [FUNCTION_GET_CONTINUOUS] = {FOR_EXCHANGE, IN(PHASE_INITIALIZATION) | EXCHANGE | AFTER},
    [FUNCTION_GET_NOMINALS] = {FOR_EXCHANGE, BEFORE | EXCHANGE | AFTER},
    [FUNCTION_GET_COUNT] = {FOR_EXCHANGE, IN(PHASE_INSTANTIATED) | IN(PHASE_EVENT)},
    [FUNCTION_SET_INPUT_DERIVATIVES] = {FOR_STEPS, BEFORE | IN(PHASE_STEP_COMPLETE)},
    [FUNCTION_GET_OUTPUT_DERIVATIVES] = {FOR_STEPS, STEPS | INTERMEDIATE | AFTER},
    [FUNCTION_DO_STEP] = {FOR_STEPS, IN(PHASE_STEP_COMPLETE)},
    [FUNCTION_GET_STATUS] = {FOR_STEPS, STEPS | IN(PHASE_TERMINATED)},
    [FUNCTION_NEVER] = {FOR_BOTH, NEVER},
};

struct Instance *enter(void *component, enum FunctionClass function, const char *name) {
  struct Instance *instance = component;
  if (instance == NULL) return NULL;
  instance->function = name;
  if ((permitted[function].kinds & IN(instance->kind)) != 0 &&
      (permitted[function].phases & IN(instance->fmu_state->phase)) != 0)
    return instance;
  log_error(instance, "%s is not allowed in the state '%s' of an instance for %s", name, instance_phase_name(instance),
            instance->kind == KIND_MODEL_EXCHANGE ? "model exchange" : "co-simulation");
  return NULL;
}
