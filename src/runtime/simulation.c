/* What both interfaces share: version, logging, experiment, initialisation, end (sections 2.1.4 to 2.1.6). */
#include <math.h>
#include <string.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"

const char *fmi2GetTypesPlatform(void) {
  return "default";
}

const char *fmi2GetVersion(void) {
  return "2.0";
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[]) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SET_DEBUG_LOGGING, "fmi2SetDebugLogging") ||
      !check_array(instance, categories, nCategories, "fmi2SetDebugLogging", "categories"))
    return fmi2Error;
  unsigned chosen = nCategories == 0 ? ALL_LOG_CATEGORIES : 0;
  for (size_t i = 0; i < nCategories; i++) {
    enum LogCategory category = categories[i] != NULL ? log_category(categories[i]) : LOG_CATEGORY_COUNT;
    if (category == LOG_CATEGORY_COUNT)
      return log_error(instance, "fmi2SetDebugLogging: there is no log category '%s'",
                       categories[i] != NULL ? categories[i] : "NULL");
    chosen |= 1u << category;
  }
  if (loggingOn) instance->log_categories |= chosen;
  else instance->log_categories &= ~chosen;
  return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_SETUP_EXPERIMENT, "fmi2SetupExperiment")) return fmi2Error;
  if (!isfinite(startTime))
    return log_error(instance, "fmi2SetupExperiment: startTime is %g; expected a finite number", startTime);
  if (stopTimeDefined && !(stopTime >= startTime && isfinite(stopTime)))
    return log_error(instance, "fmi2SetupExperiment: stopTime is %g; expected a finite number from startTime %g on",
                     stopTime, startTime);
  if (toleranceDefined && !(tolerance > 0.0 && tolerance < 1.0))
    return log_error(instance, "fmi2SetupExperiment: tolerance is %g; expected one between 0 and 1", tolerance);
  struct Situation *situation = instance->situation;
  situation->experiment_defined = 1;
  situation->stop_time_defined = stopTimeDefined ? 1 : 0;
  situation->time = situation->start_time = startTime;
  situation->stop_time = stopTimeDefined ? stopTime : 0.0;
  situation->tolerance = toleranceDefined ? tolerance : lagrangian.tolerance;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_ENTER_INITIALIZATION_MODE, "fmi2EnterInitializationMode")) return fmi2Error;
  if (!instance->situation->experiment_defined)
    return log_error(instance, "fmi2EnterInitializationMode: expected fmi2SetupExperiment before it");
  instance->situation->mode = MODE_INITIALIZATION;
  return fmi2OK;
}

/* The simulation can start only where the accelerations exist. */
static fmi2Status check_start(struct Instance *instance) {
  instance->singular = lagrangian.prepare(instance->parameter, instance->prepared);
  bool regular = instance->singular == 0;
  if (regular && lagrangian.derivatives != NULL) {
    struct Point point = evaluate_point(instance);
    regular = evaluate_derivatives(instance, &point, instance->work);
  }
  if (regular) {
    instance->prepared_is_stale = false;
    return fmi2OK;
  }
  log_singularity(instance, fmi2Error, instance->situation->time);
  return log_error(instance, "fmi2ExitInitializationMode: the system has no acceleration at its start values");
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_EXIT_INITIALIZATION_MODE, "fmi2ExitInitializationMode")) return fmi2Error;
  if (check_start(instance) != fmi2OK) return fmi2Error;
  instance->situation->mode = instance->type == fmi2ModelExchange ? MODE_EVENT : MODE_STEP_COMPLETE;
  log_message(instance, fmi2OK, "initialised at time %g", instance->situation->time);
  return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_TERMINATE, "fmi2Terminate")) return fmi2Error;
  instance->situation->mode = MODE_TERMINATED;
  log_message(instance, fmi2OK, "terminated at time %g", instance->situation->time);
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_RESET, "fmi2Reset")) return fmi2Error;
  situation_reset(instance);
  return fmi2OK;
}
