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
  bool limits = lagrangian.limit != NULL;
  size_t rows = lagrangian.state_count + lagrangian.input_count + lagrangian.series_rows;
  if (limits) vectors->series = instance->allocate(rows, sizeof(Series));
  if (vectors->state != NULL && vectors->tolerance != NULL && (!limits || vectors->series != NULL)) return true;
  log_message(instance, fmi2Error, "SUNDIALS has no memory for its vectors");
  return false;
}

void sundials_vectors_destroy(const struct Instance *instance, struct SundialsVectors *vectors) {
  if (vectors->series != NULL) instance->free(vectors->series);
  if (vectors->state != NULL) N_VDestroy(vectors->state);
  if (vectors->tolerance != NULL) N_VDestroy(vectors->tolerance);
  if (vectors->context != NULL) SUNContext_Free(&vectors->context);
}

void sundials_set_tolerances(const struct Instance *instance, struct SundialsVectors *vectors, double safety) {
  vectors->relative = fmax(safety * instance->situation->tolerance, 10 * DBL_EPSILON);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    N_VGetArrayPointer(vectors->tolerance)[i] = vectors->relative * lagrangian.nominal[i];
}

/*
 * Two terms beside the first: where the system is stiff, higher ones belong to fast modes that the method damps. Kinks,
 * roots and jumps are left to its error estimate.
 */
double sundials_longest_step(struct Instance *instance, const struct SundialsVectors *vectors, double time,
                             const double *state, double bound) {
  enum { ORDER = 3 };
  if (vectors->series == NULL) return bound;
  size_t states = lagrangian.state_count;
  Series *x = vectors->series, *input = x + states, *work = input + lagrangian.input_count;
  double *derivative = instance->work + lagrangian.input_count;
  struct Point point = solver_point(instance, time, state);
  if (lagrangian.start(&point, derivative, work) != 0) return bound;
  for (size_t i = 0; i < states; i++) {
    x[i][0] = state[i];
    x[i][1] = derivative[i];
  }
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, time, input[i]);
  lagrangian.series(&point, ORDER, (const Series *)input, x, work);
  struct SeriesLimit limit = {.order = ORDER - 1, .step = bound, .crosses = true};
  lagrangian.limit(&point, (const Series *)input, (const Series *)x, (const Series *)work, &limit);
  return limit.step;
}

bool sundials_succeeded(const struct Instance *instance, int flag, const char *call) {
  if (flag >= 0) return true;
  log_message(instance, fmi2Error, "%s of SUNDIALS failed with flag %d", call, flag);
  return false;
}

bool sundials_rests(double time, double step) {
  return step <= 8 * DBL_EPSILON * fabs(time);
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
