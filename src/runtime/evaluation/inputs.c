#include "evaluation/inputs.h"

#include <math.h>

#include "evaluation/prescribed_inputs.h"

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

/* Largest excess of a prescribed input over a limit by rounding, relative to the input or 1. */
static const double rounded_excess = 1e-12;

static double clamp(const struct ScalarVariable *variable, double value) {
  return fmin(fmax(value, variable->minimum), variable->maximum);
}

/* Returns the value of a polynomial that is farthest beyond the limits within a step of this length. */
static double farthest_beyond(const struct ScalarVariable *variable, const double *coefficient, double length) {
  double half = coefficient[2], root = sqrt(half * half - 3.0 * coefficient[1] * coefficient[3]);
  double q = half < 0.0 ? root - half : -root - half;
  const double turns[] = {length, q / (3.0 * coefficient[3]), coefficient[1] / q}; /* the end, and where it turns */
  double farthest = coefficient[0];
  for (int i = 0; i < 3; i++) {
    double s = turns[i], value = coefficient[0] + s * (coefficient[1] + s * (coefficient[2] + s * coefficient[3]));
    bool is_within = s > 0.0 && s <= length;
    if (is_within && fabs(value - clamp(variable, value)) > fabs(farthest - clamp(variable, farthest)))
      farthest = value;
  }
  return farthest;
}

/* Replaces an input's polynomial by the line to its last value, or to the limit; warns at most once an instance. */
static void straighten(struct Instance *instance, const struct ScalarVariable *variable, double length,
                       double farthest) {
  double end[INPUT_ORDER + 1], *derivative = instance->input_derivatives + variable->index;
  expand_input(instance, variable->index, instance->fmu_state->time + length, end);
  derivative[0] = (clamp(variable, end[0]) - instance->input[variable->index]) / length;
  for (size_t order = 1; order < INPUT_ORDER; order++) derivative[order * lagrangian.input_count] = 0.0;
  if (instance->reported_straight_input) return;
  instance->reported_straight_input = true;
  log_message(
      instance, STATUS_WARNING,
      "time %g: the polynomial of the input '%s' reaches %g within the step, beyond its %s; the input is linear "
      "there instead, up to the limit",
      instance->fmu_state->time, variable->name, farthest, farthest < variable->minimum ? "min" : "max");
}

/* Logs a prescribed input that leaves its limits by more than rounding; false if it does. */
static bool check_prescribed(const struct Instance *instance, const struct ScalarVariable *variable, double farthest) {
  if (fabs(farthest - clamp(variable, farthest)) <= rounded_excess * fmax(1.0, fabs(farthest))) return true;
  log_message(instance, STATUS_DISCARD,
              "time %g: the polynomial of the input '%s' reaches %g within the step, beyond its %s; expected "
              "derivatives, or a shorter step, with which it stays between its min and max",
              instance->fmu_state->time, variable->name, farthest, farthest < variable->minimum ? "min" : "max");
  return false;
}

static bool limit_input(struct Instance *instance, const struct ScalarVariable *variable, double length) {
  double coefficient[INPUT_ORDER + 1];
  expand_input(instance, variable->index, instance->fmu_state->time, coefficient);
  double farthest = farthest_beyond(variable, coefficient, length);
  if (farthest == clamp(variable, farthest)) return true;
  if (is_prescribed_input(variable->index)) return check_prescribed(instance, variable, farthest);
  straighten(instance, variable, length, farthest);
  return true;
}

bool limit_inputs(struct Instance *instance, double length) {
  bool are_within = true;
  for (size_t i = 0; i < lagrangian.variable_count && instance->fmu_state->input_derivatives_set; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    bool has_limit = isfinite(variable->minimum) || isfinite(variable->maximum);
    if (variable->kind == VARIABLE_INPUT && has_limit) are_within &= limit_input(instance, variable, length);
  }
  return are_within;
}
