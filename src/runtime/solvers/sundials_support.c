#include "sundials_support.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluate.h"

bool sundials_create(struct Instance *instance, size_t size, bool (*configure)(struct Instance *instance)) {
  sunindextype states = (sunindextype)lagrangian.state_count;
  struct Sundials *sundials = instance->solver_memory = sundials_allocate(1, size);
  if (SUNContext_Create(NULL, &sundials->context) == 0) {
    sundials->state = N_VNew_Serial(states, sundials->context);
    sundials->inside = N_VNew_Serial(states, sundials->context);
    sundials->tolerance = N_VNew_Serial(states, sundials->context);
    size_t rows = lagrangian.state_count + lagrangian.input_count + lagrangian.series_rows;
    if (lagrangian.limit != NULL) sundials->series = sundials_allocate(rows, sizeof(Series));
    memcpy(N_VGetArrayPointer(sundials->state), instance->state, lagrangian.state_count * sizeof(double));
    if (configure(instance)) return true;
  }
  instance->solver_memory = NULL;
  return false;
}

void sundials_load(const struct Instance *instance, double safety) {
  struct Sundials *sundials = instance->solver_memory;
  memcpy(N_VGetArrayPointer(sundials->state), instance->state, lagrangian.state_count * sizeof(double));
  sundials->relative = fmax(safety * instance->situation->tolerance, 10 * DBL_EPSILON);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    N_VGetArrayPointer(sundials->tolerance)[i] = sundials->relative * lagrangian.nominal[i];
}

int sundials_right_side(realtype time, N_Vector state, N_Vector derivative, void *instance) {
  bool exists = solver_derivatives(instance, time, N_VGetArrayPointer(state), N_VGetArrayPointer(derivative));
  return exists ? 0 : 1; /* recoverable: a shorter step may avoid the point */
}

void sundials_copy(N_Vector vector, double *state) {
  memcpy(state, N_VGetArrayPointer(vector), lagrangian.state_count * sizeof(double));
}

/*
 * Two terms beside the first: where the system is stiff, higher ones belong to fast modes that the method damps. Kinks,
 * roots and jumps are left to its error estimate.
 */
double sundials_longest_step(struct Instance *instance, double time, double bound) {
  enum { ORDER = 3 };
  const struct Sundials *sundials = instance->solver_memory;
  if (sundials->series == NULL) return bound;
  size_t states = lagrangian.state_count;
  Series *x = sundials->series, *input = x + states, *work = input + lagrangian.input_count;
  const double *state = N_VGetArrayPointer(sundials->state);
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
  log_message(instance, STATUS_ERROR, "%s of SUNDIALS failed with flag %d", call, flag);
  return false;
}

bool sundials_tiny_step(struct Instance *instance, const struct CommunicationStep *step) {
  const struct Sundials *sundials = instance->solver_memory;
  struct Situation *situation = instance->situation;
  double size = step->end - step->start;
  bool is_tiny = size <= 8 * DBL_EPSILON * fmax(fabs(step->start), fabs(step->end));
  if (!is_tiny || situation->last_step.end != step->start) return false;
  double *state = N_VGetArrayPointer(sundials->state), *derivative = instance->work + lagrangian.input_count;
  if (!solver_derivatives(instance, step->start, state, derivative)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++) state[i] += size * derivative[i];
  situation->last_step = (struct Span){step->start, step->end};
  situation->statistics[STATISTIC_STEPS]++;
  situation->changed = 1;
  return true;
}

void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data) {
  (void)code;
  (void)module;
  (void)function;
  (void)message;
  (void)data;
}
