#include "evaluation/inputs.h"

void expand_input(const struct Instance *instance, size_t i, double time, double *coefficient) {
  double s = time - instance->fmu_state->time;
  size_t n = lagrangian.input_count;
  const double *d = instance->input_derivatives + i;
  coefficient[0] = instance->input[i] + s * (d[0] + s / 2 * (d[n] + s / 3 * d[2 * n]));
  coefficient[1] = d[0] + s * (d[n] + s / 2 * d[2 * n]);
  coefficient[2] = (d[n] + s * d[2 * n]) / 2;
  coefficient[3] = d[2 * n] / 6;
}

void evaluate_inputs(const struct Instance *instance, double time, double *input) {
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    double coefficient[INPUT_ORDER + 1];
    expand_input(instance, i, time, coefficient);
    input[i] = coefficient[0];
  }
}

void evaluate_advance_inputs(struct Instance *instance, double end) {
  if (!instance->fmu_state->input_derivatives_set) return;
  size_t n = lagrangian.input_count;
  for (size_t i = 0; i < n; i++) {
    double coefficient[INPUT_ORDER + 1], *derivative = instance->input_derivatives + i;
    expand_input(instance, i, end, coefficient);
    instance->input[i] = coefficient[0];
    derivative[0] = coefficient[1];
    derivative[n] = 2.0 * coefficient[2];
  }
  instance->fmu_state->changed = CHANGED_COURSE;
}
