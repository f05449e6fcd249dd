/* Derivatives of outputs (section 4.2.1): the coefficients of their Taylor series in time. */
#include <math.h>

#include "check.h"
#include "evaluate.h"
#include "log.h"

/* Series about the present time; the rows are parts of one block. */
struct Expansion {
  Series *state, *input, *output, *work;
  double *matrix; /* of a linear system */
};

static size_t larger(size_t a, size_t b) {
  return a > b ? a : b;
}

/* False after logging where there is no memory. Free expansion->state. */
static bool expansion_create(struct Instance *instance, struct Expansion *expansion) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count;
  size_t work = larger(lagrangian.series_rows, lagrangian.output_series_rows);
  size_t rows = states + inputs + lagrangian.result_count + work;
  size_t matrix = lagrangian.linear == NULL ? 0 : states * (states + inputs + 1);
  expansion->state = instance->allocate(1, rows * sizeof(Series) + matrix * sizeof(double));
  if (expansion->state == NULL) {
    log_error(instance, "allocateMemory returned no memory for the derivatives of outputs");
    return false;
  }
  expansion->input = expansion->state + states;
  expansion->output = expansion->input + inputs;
  expansion->work = expansion->output + lagrangian.result_count;
  expansion->matrix = (double *)(expansion->work + work);
  return true;
}

/* d x / dt = A x + B u + c, order by order. */
static void expand_linear(const struct Instance *instance, int order, const struct Expansion *expansion) {
  size_t states = lagrangian.state_count, columns = states + lagrangian.input_count + 1;
  lagrangian.linear(instance->parameter, instance->prepared, expansion->matrix);
  for (size_t i = 0; i < states; i++) expansion->state[i][0] = instance->state[i];
  for (int k = 0; k < order; k++)
    for (size_t i = 0; i < states; i++) {
      const double *row = expansion->matrix + i * columns;
      double sum = k == 0 ? row[columns - 1] : 0.0;
      for (size_t j = 0; j + 1 < columns; j++) sum += row[j] * expansion->state[j][k]; /* the inputs follow */
      expansion->state[i][k + 1] = sum / (k + 1);
    }
}

static fmi2Status expand(struct Instance *instance, int order, const struct Expansion *expansion) {
  struct Point point = evaluate_point(instance);
  const Series *input = (const Series *)expansion->input;
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, point.time, expansion->input[i]);
  if (lagrangian.linear != NULL) expand_linear(instance, order + 1, expansion);
  if (lagrangian.series != NULL) {
    instance->singular = lagrangian.start(&point, instance->work, expansion->work);
    if (instance->singular != 0) {
      log_singularity(instance, fmi2Discard, point.time);
      return fmi2Discard;
    }
    for (size_t i = 0; i < lagrangian.state_count; i++) {
      expansion->state[i][0] = instance->state[i];
      expansion->state[i][1] = instance->work[i];
    }
    lagrangian.series(&point, order + 1, input, expansion->state, expansion->work);
  }
  if (lagrangian.output_series != NULL)
    lagrangian.output_series(&point, order, input, (const Series *)expansion->state, expansion->work,
                             expansion->output);
  return fmi2OK;
}

static fmi2Status read_derivative(struct Instance *instance, const struct Expansion *expansion,
                                  const struct ScalarVariable *variable, int order, double *value) {
  Series *rows = variable->kind == VARIABLE_STATE ? expansion->state : expansion->output;
  double derivative = rows[variable->index][order];
  for (int k = 2; k <= order; k++) derivative *= k;
  if (!isfinite(derivative)) {
    log_message(instance, fmi2Discard, "fmi2GetRealOutputDerivatives: the derivative %d of '%s' is not finite here",
                order, variable->name);
    return fmi2Discard;
  }
  *value = derivative;
  return fmi2OK;
}

static fmi2Status read_from_series(struct Instance *instance, const fmi2ValueReference *vr, size_t nvr,
                                   const fmi2Integer *order, double *value) {
  struct Expansion expansion;
  int highest = 0;
  for (size_t i = 0; i < nvr; i++) highest = order[i] > highest ? order[i] : highest;
  if (!expansion_create(instance, &expansion)) return fmi2Error;
  fmi2Status status = expand(instance, highest, &expansion);
  for (size_t i = 0; i < nvr && status == fmi2OK; i++)
    status = read_derivative(instance, &expansion, &lagrangian.variables[vr[i]], order[i], &value[i]);
  instance->free(expansion.state);
  return status;
}

static fmi2Status check_output_derivative(struct Instance *instance, fmi2ValueReference reference, int order) {
  static const char *const name = "fmi2GetRealOutputDerivatives";
  const struct ScalarVariable *variable = check_reference(instance, reference, false, name);
  if (variable == NULL) return fmi2Error;
  if (!variable->is_output) return log_error(instance, "%s: '%s' is no output", name, variable->name);
  if (order >= 1 && order <= lagrangian.output_derivative_order) return fmi2OK;
  return log_error(instance, "%s: the order %d for '%s' is out of range; expected 1 to %d", name, order, variable->name,
                   lagrangian.output_derivative_order);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
  static const char *const name = "fmi2GetRealOutputDerivatives";
  struct Instance *instance = c;
  if (instance == NULL) return fmi2Error;
  if (!check_call(instance, FUNCTION_GET_OUTPUT_DERIVATIVES, name) || !check_array(instance, vr, nvr, name, "vr") ||
      !check_array(instance, order, nvr, name, "order") || !check_array(instance, value, nvr, name, "value"))
    return fmi2Error;
  for (size_t i = 0; i < nvr; i++)
    if (check_output_derivative(instance, vr[i], order[i]) != fmi2OK) return fmi2Error;
  fmi2Status status = evaluate_prepare(instance);
  if (status != fmi2OK) return status;
  return lagrangian.output_derivative_order == 1 ? derivatives_in_time(instance, vr, nvr, value)
                                                 : read_from_series(instance, vr, nvr, order, value);
}
