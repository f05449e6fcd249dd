#include "sundials_support.h"

#include <float.h>
#include <math.h>

#include "evaluate.h"
#include "log.h"
#include "solver.h"

const char resting_steps[] = "the steps become too short to change the time, as at a singularity";

bool sundials_vectors_create(struct Instance *instance, struct SundialsVectors *vectors) {
  if (SUNContext_Create(NULL, &vectors->context) == 0) {
    vectors->state = N_VNew_Serial((sunindextype)lagrangian.state_count, vectors->context);
    vectors->tolerance = N_VNew_Serial((sunindextype)lagrangian.state_count, vectors->context);
  }
  if (vectors->state != NULL && vectors->tolerance != NULL) return true;
  log_message(instance, fmi2Error, "SUNDIALS has no memory for its vectors");
  return false;
}

void sundials_vectors_destroy(struct SundialsVectors *vectors) {
  if (vectors->state != NULL) N_VDestroy(vectors->state);
  if (vectors->tolerance != NULL) N_VDestroy(vectors->tolerance);
  if (vectors->context != NULL) SUNContext_Free(&vectors->context);
}

void sundials_set_tolerances(const struct Instance *instance, struct SundialsVectors *vectors, double safety) {
  vectors->relative = fmax(safety * instance->situation->tolerance, 10 * DBL_EPSILON);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    N_VGetArrayPointer(vectors->tolerance)[i] = vectors->relative * lagrangian.nominal[i];
}

bool sundials_succeeded(const struct Instance *instance, int flag, const char *call) {
  if (flag >= 0) return true;
  log_message(instance, fmi2Error, "%s of SUNDIALS failed with flag %d", call, flag);
  return false;
}

bool sundials_tiny_step(struct Instance *instance, double end) {
  double time = instance->situation->time, step = end - time;
  if (step > 8 * DBL_EPSILON * fmax(fabs(time), fabs(end))) return false;
  double *derivative = instance->work + lagrangian.input_count;
  if (!solver_derivatives(instance, time, instance->state, derivative)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++) instance->state[i] += step * derivative[i];
  instance->situation->statistics[STATISTIC_STEPS]++;
  instance->situation->changed = 1;
  return true;
}

void sundials_log_stop(struct Instance *instance, const char *solver, const char *reason, double reached, double end) {
  if (instance->singular != 0) log_singularity(instance, fmi2Discard, reached);
  log_message(instance, fmi2Discard,
              "%s stopped at time %.15g before %.15g (%s): retrying will not help; go on from an earlier state with "
              "a larger tolerance, other parameters or other coordinates",
              solver, reached, end, reason);
}

void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data) {
  (void)code;
  (void)module;
  (void)function;
  (void)message;
  (void)data;
}
