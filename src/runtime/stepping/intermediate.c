#include "stepping/intermediate.h"

#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"

/* Gives the instance the values of a time within the step. False if they do not exist. */
static bool move_to(struct Instance *instance, double time) {
  if (!solver_take_state(instance, time) || solver_project(instance, time, instance->state) != NULL) return false;
  evaluate_advance_inputs(instance, time); /* from the time of the snapshot */
  instance->fmu_state->time = time;
  instance->fmu_state->phase = PHASE_INTERMEDIATE_UPDATE;
  return true;
}

void intermediate_observe(struct Instance *instance, struct CommunicationStep *step, double time) {
  const struct Intermediate *intermediate = instance->intermediate;
  int singular = instance->singular;
  double end = step->end;
  memcpy(intermediate->kept, instance->fmu_state, fmu_state_size());
  bool has_values = move_to(instance, time);
  if (has_values) end = intermediate->update(intermediate->receiver, time, end);
  bool failed = instance->fmu_state->phase == PHASE_ERROR;
  memcpy(instance->fmu_state, intermediate->kept, fmu_state_size());
  instance->singular = singular;
  if (failed) {
    instance->fmu_state->phase = PHASE_ERROR;
    end = time;
  }
  if (!(end < step->end)) return;
  step->end = fmax(time, end);
  step->length = step->end - step->start;
}

/*
 * The nodes of Lobatto's quadrature of order 6. Both ends are among them, so that inputs are continuous from step to
 * step. A smooth input and its cubic differ by O(h^4), and so do outputs that depend on it directly; the motion errs by
 * O(h^6).
 */
static const double node[INPUT_NODES] = {0.0, 0.276393202250021030, 0.723606797749978970, 1.0};

/*
 * Writes the derivatives of orders 1 to 3, at the step's start, of the cubic through values at the nodes. Overwrites
 * the values.
 */
static void differentiate_cubic(double *value, double length, double *derivative, size_t stride) {
  for (size_t order = 1; order < INPUT_NODES; order++) /* Newton's divided differences */
    for (size_t i = INPUT_NODES - 1; i >= order; i--)
      value[i] = (value[i] - value[i - 1]) / (node[i] - node[i - order]);
  double a = node[1], b = node[2];
  derivative[0] = (value[1] - a * value[2] + a * b * value[3]) / length;
  derivative[stride] = 2.0 * (value[2] - (a + b) * value[3]) / (length * length);
  derivative[2 * stride] = 6.0 * value[3] / (length * length * length);
}

void intermediate_request_inputs(struct Instance *instance, const struct CommunicationStep *step) {
  const struct Intermediate *intermediate = instance->intermediate;
  struct FmuState *fmu_state = instance->fmu_state;
  size_t n = lagrangian.input_count;
  int32_t phase = fmu_state->phase;
  fmu_state->phase = PHASE_INPUT_REQUEST;
  for (size_t k = 0; k < INPUT_NODES; k++) {
    intermediate->request(intermediate->receiver,
                          k + 1 < INPUT_NODES ? step->start + node[k] * step->length : step->end);
    if (fmu_state->phase == PHASE_ERROR) return;
    for (size_t i = 0; i < n; i++) intermediate->inputs[i * INPUT_NODES + k] = instance->input[i];
  }
  fmu_state->phase = phase;
  for (size_t i = 0; i < n; i++) {
    double *value = intermediate->inputs + i * INPUT_NODES;
    instance->input[i] = value[0];
    differentiate_cubic(value, step->length, instance->input_derivatives + i, n);
  }
  for (size_t i = 0; i < INPUT_ORDER * n; i++) {
    if (instance->input_derivatives[i] != 0.0) fmu_state->input_derivatives_set = 1;
    if (isfinite(instance->input_derivatives[i])) continue;
    reject_call(instance, "an input changes too fast within the step from time %g; expected smaller values",
                step->start);
    return;
  }
}
