/* Time derivatives of outputs, k! times the coefficients of their Taylor series. */
#include <math.h>

#include "evaluation/evaluate.h"
#include "evaluation/inputs.h"
#include "fmi/check.h"
#include "fmi/derivatives.h"
#include "stepping/reading.h"
#include "support/arena.h"

/* Series about the present time; the rows are parts of one block. */
struct OutputSeries {
  Series *state, *input, *output, *work;
  double *matrix; /* of a linear system */
};

static size_t larger(size_t a, size_t b) {
  return a > b ? a : b;
}

static size_t lay_out_expansion(struct OutputSeries *expansion, void *block) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_TAKE(&arena, expansion->state, states);
  ARENA_TAKE(&arena, expansion->input, inputs);
  ARENA_TAKE(&arena, expansion->output, lagrangian.results.count);
  ARENA_TAKE(&arena, expansion->work, larger(lagrangian.taylor.rows, lagrangian.taylor.output_rows));
  ARENA_NUMBERS(&arena, lagrangian.linear == NULL ? 0 : states * (states + inputs + 1), &expansion->matrix);
  return arena.next - (uintptr_t)block;
}

/* Expands d x / dt = A x + B u + c, order by order. */
static void expand_linear(const struct Instance *instance, int order, const struct OutputSeries *expansion) {
  size_t states = lagrangian.state_count, columns = states + lagrangian.input_count + 1;
  lagrangian.linear(instance->parameter, instance->parameter_constants, expansion->matrix);
  for (size_t i = 0; i < states; i++) expansion->state[i][0] = instance->state[i];
  for (int k = 0; k < order; k++)
    for (size_t i = 0; i < states; i++) {
      const double *row = expansion->matrix + i * columns;
      double sum = k == 0 ? row[columns - 1] : 0.0;
      for (size_t j = 0; j + 1 < columns; j++) sum += row[j] * expansion->state[j][k]; /* then the inputs */
      expansion->state[i][k + 1] = sum / (k + 1);
    }
}

static enum Status fill_expansion(struct Instance *instance, int order, const struct OutputSeries *expansion) {
  struct Point point = instance_point(instance);
  const Series *input = (const Series *)expansion->input;
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, point.time, expansion->input[i]);
  if (lagrangian.linear != NULL) expand_linear(instance, order + 1, expansion);
  if (lagrangian.taylor.series != NULL) {
    instance->singular = lagrangian.taylor.start(&point, instance->work, expansion->work);
    if (instance->singular != 0) return discard_for_singularity(instance);
    for (size_t i = 0; i < lagrangian.state_count; i++) {
      expansion->state[i][0] = instance->state[i];
      expansion->state[i][1] = instance->work[i];
    }
    lagrangian.taylor.series(&point, order + 1, input, expansion->state, expansion->work);
  }
  if (lagrangian.taylor.output_series != NULL)
    lagrangian.taylor.output_series(&point, order, input, (const Series *)expansion->state, expansion->work,
                                    expansion->output);
  return STATUS_DONE;
}

static enum Status read_derivative(struct Instance *instance, const struct OutputSeries *expansion,
                                   const struct ScalarVariable *variable, int order, double *value) {
  Series *rows = variable->kind == VARIABLE_STATE ? expansion->state : expansion->output;
  double derivative = rows[variable->index][order];
  for (int k = 2; k <= order; k++) derivative *= k;
  if (!isfinite(derivative))
    return discard_call(instance, "the derivative %d of '%s' is not finite", order, variable->name);
  *value = derivative;
  return STATUS_DONE;
}

static enum Status read_from_series(struct Instance *instance, const unsigned *reference, size_t count,
                                    const int *order, double *value) {
  struct OutputSeries expansion;
  int highest = 0;
  for (size_t i = 0; i < count; i++) highest = order[i] > highest ? order[i] : highest;
  void *block = instance->memory.allocate(1, lay_out_expansion(&expansion, NULL));
  if (block == NULL) return reject_call(instance, "out of memory for the derivatives of outputs");
  lay_out_expansion(&expansion, block);
  enum Status status = fill_expansion(instance, highest, &expansion);
  for (size_t i = 0; i < count && status == STATUS_DONE; i++)
    status = read_derivative(instance, &expansion, &lagrangian.variables[reference[i]], order[i], &value[i]);
  instance->memory.free(block);
  return status;
}

static enum Status check_output_derivative(struct Instance *instance, unsigned reference, int order) {
  const struct ScalarVariable *variable = check_reference(instance, reference, TYPE_REAL);
  if (variable == NULL) return STATUS_ERROR;
  if (!variable->is_output) return reject_call(instance, "'%s' is not an output", variable->name);
  if (order >= 1 && order <= lagrangian.output_derivative_order) return STATUS_DONE;
  return reject_call(instance, "the order %d for '%s' is out of range; expected 1 to %d", order, variable->name,
                     lagrangian.output_derivative_order);
}

enum Status output_derivatives(struct Instance *instance, const unsigned *reference, size_t count, const int *order,
                               double *value) {
  for (size_t i = 0; i < count; i++)
    if (check_output_derivative(instance, reference[i], order[i]) != STATUS_DONE) return STATUS_ERROR;
  reading_begin(instance);
  enum Status status = evaluate_prepare(instance);
  if (status == STATUS_DONE)
    status = lagrangian.output_derivative_order == 1 ? derivatives_in_time(instance, reference, count, value)
                                                     : read_from_series(instance, reference, count, order, value);
  reading_end(instance);
  return status;
}
