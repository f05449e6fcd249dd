#include "methods/sundials/sundials_support.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "methods/first_terms.h"

bool sundials_create(struct Instance *instance, size_t size, bool (*configure)(struct Instance *instance)) {
  sunindextype states = (sunindextype)lagrangian.state_count;
  struct Sundials *sundials = instance->solver_memory = sundials_allocate(1, size);
  if (SUNContext_Create(NULL, &sundials->context) == 0) {
    sundials->state = N_VNew_Serial(states, sundials->context);
    sundials->inside = N_VNew_Serial(states, sundials->context);
    sundials->tolerance = N_VNew_Serial(states, sundials->context);
    size_t rows = first_terms_rows();
    if (rows > 0) sundials->series = sundials_allocate(rows, sizeof(Series));
    memcpy(N_VGetArrayPointer(sundials->state), instance->state, lagrangian.state_count * sizeof(double));
    if (configure(instance)) return true;
  }
  instance->solver_memory = NULL;
  return false;
}

void sundials_load(const struct Instance *instance, const double *state, double safety) {
  struct Sundials *sundials = instance->solver_memory;
  memcpy(N_VGetArrayPointer(sundials->state), state, lagrangian.state_count * sizeof(double));
  sundials->relative = fmax(safety * instance->fmu_state->tolerance, 10 * DBL_EPSILON);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    N_VGetArrayPointer(sundials->tolerance)[i] = sundials->relative * lagrangian.steps.nominal[i];
}

int sundials_right_side(realtype time, N_Vector state, N_Vector derivative, void *instance) {
  bool exists = solver_derivatives_beyond(instance, time, N_VGetArrayPointer(state), N_VGetArrayPointer(derivative));
  return exists ? 0 : 1; /* recoverable: a shorter step may avoid the point */
}

bool sundials_interpolate(struct Instance *instance,
                          int (*evaluate)(void *memory, realtype time, int order, N_Vector y), void *memory,
                          double time, double *state) {
  const struct Sundials *sundials = instance->solver_memory;
  bool is_end = time == instance->fmu_state->last_step.end;
  if (!is_end && evaluate(memory, time, 0, sundials->inside) < 0) return false;
  memcpy(state, N_VGetArrayPointer(is_end ? sundials->state : sundials->inside),
         lagrangian.state_count * sizeof(double));
  return true;
}

double sundials_longest_step(struct Instance *instance, double time, double bound) {
  const struct Sundials *sundials = instance->solver_memory;
  return first_terms_step(instance, sundials->series, time, N_VGetArrayPointer(sundials->state), bound);
}

bool sundials_succeeded(const struct Instance *instance, int flag, const char *call) {
  if (flag >= 0) return true;
  log_message(instance, STATUS_ERROR, "%s of SUNDIALS failed with flag %d", call, flag);
  return false;
}

bool sundials_tiny_step(struct Instance *instance, const struct CommunicationStep *step) {
  const struct Sundials *sundials = instance->solver_memory;
  struct FmuState *fmu_state = instance->fmu_state;
  double start = fmu_state->last_step.end, size = step->end - start;
  if (size > 8 * DBL_EPSILON * fmax(fabs(start), fabs(step->end))) return false;
  double *state = N_VGetArrayPointer(sundials->state), *derivative = instance->work + lagrangian.input_count;
  if (!solver_derivatives(instance, start, state, derivative)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++) state[i] += size * derivative[i];
  fmu_state->last_step = (struct Span){start, step->end};
  fmu_state->statistics[STATISTIC_STEPS]++;
  fmu_state->changed = CHANGED_VALUES;
  return true;
}

void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data) {
  (void)code;
  (void)module;
  (void)function;
  (void)message;
  (void)data;
}
