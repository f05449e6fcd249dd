/* What both interfaces share: version, experiment, initialisation, end (sections 2.1.4 and 2.1.6). */
#include "fmi/simulation.h"
#include "fmi2/fmi2_life_cycle.h"

const char *fmi2GetTypesPlatform(void) {
  return "default";
}

const char *fmi2GetVersion(void) {
  return "2.0";
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
  struct Instance *instance = enter(c, FUNCTION_SETUP_EXPERIMENT, __func__);
  if (instance == NULL) return fmi2Error;
  struct Experiment experiment = {.start_time = startTime,
                                  .stop_time = stopTime,
                                  .tolerance = tolerance,
                                  .has_stop_time = stopTimeDefined != fmi2False,
                                  .has_tolerance = toleranceDefined != fmi2False};
  return fmi2_status(simulation_set_up(instance, &experiment, __func__));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_INITIALIZATION_MODE, __func__);
  if (instance == NULL) return fmi2Error;
  if (!instance->situation->experiment_defined)
    return fmi2_status(log_error(instance, "%s: expected fmi2SetupExperiment before it", __func__));
  instance->situation->mode = MODE_INITIALIZATION;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_EXIT_INITIALIZATION_MODE, __func__);
  return instance == NULL ? fmi2Error : fmi2_status(simulation_start(instance, __func__));
}

fmi2Status fmi2Terminate(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_TERMINATE, __func__);
  if (instance == NULL) return fmi2Error;
  simulation_terminate(instance);
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
  struct Instance *instance = enter(c, FUNCTION_RESET, __func__);
  if (instance == NULL) return fmi2Error;
  instance_reset(instance);
  return fmi2OK;
}
