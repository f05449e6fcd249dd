/*
 * FMI 2.0 without values and communication steps: version, experiment, initialization, end, saved states (sections
 * 2.1.4 to 2.1.8), and model exchange (section 3.2).
 */
#include "fmi/life_cycle.h"
#include "fmi2/fmi2_component.h"

#define FMI(name) fmi2##name
#define fmi2GetFMUState fmi2GetFMUstate
#define fmi2SetFMUState fmi2SetFMUstate
#define fmi2FreeFMUState fmi2FreeFMUstate
#define fmi2SerializedFMUStateSize fmi2SerializedFMUstateSize
#define fmi2SerializeFMUState fmi2SerializeFMUstate
#define fmi2DeserializeFMUState fmi2DeSerializeFMUstate
#define fmi2GetContinuousStateDerivatives fmi2GetDerivatives
#define NOMINALS FUNCTION_GET_NOMINALS
#define QUIET_CATEGORIES PROBLEM_CATEGORIES /* warnings and errors are sent without debug logging too */
#include "fmi/shared_functions.h"

const char *fmi2GetTypesPlatform(void) {
  return "default";
}

const char *fmi2GetVersion(void) {
  return "2.0";
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
  struct Instance *instance = enter(c, FUNCTION_SET_UP, __func__);
  if (instance == NULL) return fmi2Error;
  struct ExperimentSetup experiment = {.start_time = startTime,
                                       .stop_time = stopTime,
                                       .tolerance = tolerance,
                                       .has_stop_time = stopTimeDefined != fmi2False,
                                       .has_tolerance = toleranceDefined != fmi2False};
  return status_of(simulation_set_up(instance, &experiment));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_SET_UP, __func__);
  if (instance == NULL) return fmi2Error;
  if (!instance->fmu_state->experiment_defined)
    return status_of(reject_call(instance, "fmi2SetupExperiment was not called; expected it before this function"));
  instance->fmu_state->phase = PHASE_INITIALIZATION;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_EXIT_INITIALIZATION_MODE, __func__);
  return instance == NULL ? fmi2Error : status_of(simulation_start(instance));
}

fmi2Status fmi2EnterEventMode(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_EVENT_MODE, __func__);
  return instance == NULL ? fmi2Error : status_of(exchange_enter_event_mode(instance));
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo) {
  struct Instance *instance = enter(c, FUNCTION_UPDATE_DISCRETE_STATES, __func__);
  if (instance == NULL || !check_array(instance, eventInfo, 1, "eventInfo")) return fmi2Error;
  *eventInfo = (fmi2EventInfo){0};
  bool states_changed;
  enum Status status = exchange_update(instance, &states_changed);
  eventInfo->valuesOfContinuousStatesChanged = states_changed;
  if (status == STATUS_DONE) eventInfo->nextEventTimeDefined = exchange_next_event(instance, &eventInfo->nextEventTime);
  return status_of(status);
}
