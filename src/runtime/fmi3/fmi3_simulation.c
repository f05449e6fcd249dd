/* What both interfaces share: version, initialization, end (section 2.3). */
#include "fmi/simulation.h"
#include "fmi3/fmi3_life_cycle.h"

const char *fmi3GetVersion(void) {
  return "3.0";
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) {
  struct Instance *instance = enter(c, FUNCTION_ENTER_INITIALIZATION_MODE, __func__);
  if (instance == NULL) return fmi3Error;
  struct Experiment experiment = {.start_time = startTime,
                                  .stop_time = stopTime,
                                  .tolerance = tolerance,
                                  .has_stop_time = stopTimeDefined,
                                  .has_tolerance = toleranceDefined};
  enum Status status = simulation_set_up(instance, &experiment, __func__);
  if (status == STATUS_DONE) instance->situation->mode = MODE_INITIALIZATION;
  return fmi3_status(status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_EXIT_INITIALIZATION_MODE, __func__);
  if (instance == NULL) return fmi3Error;
  enum Status status = simulation_start(instance, __func__);
  if (status == STATUS_DONE && instance->uses_event_mode) instance->situation->mode = MODE_EVENT;
  return fmi3_status(status);
}

fmi3Status fmi3Terminate(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_TERMINATE, __func__);
  if (instance == NULL) return fmi3Error;
  simulation_terminate(instance);
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
  struct Instance *instance = enter(c, FUNCTION_RESET, __func__);
  if (instance == NULL) return fmi3Error;
  instance_reset(instance);
  return fmi3OK;
}

/* There are no structural parameters that could be configured. */
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
  enter(c, FUNCTION_CONFIGURATION_MODE, __func__);
  return fmi3Error;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
  enter(c, FUNCTION_CONFIGURATION_MODE, __func__);
  return fmi3Error;
}
