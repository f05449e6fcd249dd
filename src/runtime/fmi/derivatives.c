#include "fmi/derivatives.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "fmi/check.h"
#include "fmi/reverse_sweep.h"
#include "instance/initial_state.h"
#include "stepping/reading.h"
#include "support/arena.h"

/* A direction and the derivatives along it; the arrays are parts of instance->work. */
struct Direction {
  struct Seed seed;
  double *state, *input, *parameter;
  double *derivative, *derivative_along;
  const double *acceleration, *acceleration_along; /* arguments of result_along() */
};

static struct Direction direction_create(struct Instance *instance) {
  struct Direction direction = {.acceleration = NULL};
  struct Arena arena = {(uintptr_t)instance->work};
  ARENA_NUMBERS(&arena, lagrangian.state_count, &direction.derivative, &direction.derivative_along, &direction.state);
  ARENA_NUMBERS(&arena, lagrangian.input_count, &direction.input);
  ARENA_NUMBERS(&arena, lagrangian.parameter_count, &direction.parameter);
  memset(instance->work, 0, arena.next - (uintptr_t)instance->work);
  direction.seed = (struct Seed){.state = direction.state, .input = direction.input, .parameter = direction.parameter};
  return direction;
}

/* Computes derivative and derivative_along at the point. */
static enum Status follow(struct Instance *instance, const struct Point *point, struct Direction *direction) {
  if (lagrangian.derivatives == NULL) return STATUS_DONE;
  if (!evaluate_derivatives(instance, point, direction->derivative)) return discard_for_singularity(instance);
  instance->singular = lagrangian.directional(point, &direction->seed, direction->derivative_along);
  if (instance->singular != 0) return STATUS_DISCARD;
  direction->acceleration = evaluate_accelerations(instance, point, direction->derivative);
  direction->acceleration_along =
      evaluate_accelerations_along(instance, point, &direction->seed, direction->derivative_along);
  return instance->singular == 0 ? STATUS_DONE : STATUS_DISCARD;
}

/* Adds to the seed, since a list may contain a known several times. */
static enum Status add_seed(struct Instance *instance, struct Direction *direction,
                            const struct ScalarVariable *variable, double value) {
  if (!isfinite(value))
    return reject_call(instance, "the seed of '%s' is %g; expected a finite number", variable->name, value);
  switch (variable->kind) {
  case VARIABLE_TIME: direction->seed.time += value; return STATUS_DONE;
  case VARIABLE_STATE: direction->state[variable->index] += value; return STATUS_DONE;
  case VARIABLE_INPUT: direction->input[variable->index] += value; return STATUS_DONE;
  case VARIABLE_PARAMETER: direction->parameter[variable->index] += value; return STATUS_DONE;
  case VARIABLE_MODE: /* its start value is a known of initialization mode */
    if (!is_before_start(instance)) break;
    direction->parameter[variable->index] += value;
    return STATUS_DONE;
  default: break;
  }
  return reject_call(instance, "'%s' is not a known; expected a state, an input or a parameter", variable->name);
}

static enum Status check_unknown(struct Instance *instance, const struct ScalarVariable *variable) {
  if (is_unknown(variable)) return STATUS_DONE;
  return reject_call(instance, "'%s' is not an unknown; expected an output or a state derivative", variable->name);
}

/* Computes the unknowns' derivatives along the direction. */
static enum Status read_along(struct Instance *instance, const struct Point *point, const struct Direction *direction,
                              const unsigned *reference, size_t count, double *value) {
  for (size_t i = 0; i < count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[reference[i]];
    double derivative = evaluate_along(variable, point, &direction->seed, direction->derivative_along,
                                       direction->acceleration, direction->acceleration_along);
    if (!isfinite(derivative))
      return discard_call(
          instance, "the derivative of '%s' is not finite, as that of sqrt(x) at x = 0; expected a state beside it",
          variable->name);
    value[i] = derivative;
  }
  return STATUS_DONE;
}

static enum Status derivative_along_seed(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                         const unsigned *known, size_t known_count, const double *seed, double *value) {
  struct Direction direction = direction_create(instance);
  for (size_t i = 0; i < known_count; i++) {
    const struct ScalarVariable *variable = check_reference(instance, known[i], TYPE_REAL);
    if (variable == NULL || add_seed(instance, &direction, variable, seed[i]) != STATUS_DONE) return STATUS_ERROR;
  }
  for (size_t i = 0; i < unknown_count; i++) {
    const struct ScalarVariable *variable = check_reference(instance, unknown[i], TYPE_REAL);
    if (variable == NULL || check_unknown(instance, variable) != STATUS_DONE) return STATUS_ERROR;
  }
  initial_state_add_along(instance, direction.state, direction.parameter);
  enum Status status = reading_follow_start(instance, &direction.seed, direction.state);
  if (status == STATUS_DONE) status = evaluate_prepare(instance);
  struct Point point = evaluate_point(instance);
  if (status == STATUS_DONE) status = follow(instance, &point, &direction);
  if (status != STATUS_DONE) return status;
  return read_along(instance, &point, &direction, unknown, unknown_count, value);
}

enum Status directional_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                   const unsigned *known, size_t known_count, const double *seed, double *value) {
  reading_begin(instance);
  enum Status status = derivative_along_seed(instance, unknown, unknown_count, known, known_count, seed, value);
  reading_end(instance);
  return status;
}

/* Computes the seed-weighted sum of the derivatives of all unknowns by one known. column: workspace, unknown_count. */
static enum Status weighted_column(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                   unsigned known, const double *seed, double *column, double *value) {
  const double one = 1.0;
  enum Status status = directional_derivative(instance, unknown, unknown_count, &known, 1, &one, column);
  double sum = 0.0;
  for (size_t i = 0; i < unknown_count && status == STATUS_DONE; i++) sum += seed[i] * column[i];
  if (status == STATUS_DONE) *value = sum;
  return status;
}

static enum Status reverse_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                      const unsigned *known, size_t known_count, const double *seed, double *value) {
  reading_begin(instance);
  enum Status status =
      lagrangian.reverse_sweep->derivative(instance, unknown, unknown_count, known, known_count, seed, value);
  reading_end(instance);
  return status;
}

enum Status adjoint_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                               const unsigned *known, size_t known_count, const double *seed, double *value) {
  for (size_t i = 0; i < unknown_count; i++)
    if (!isfinite(seed[i])) return reject_call(instance, "seed %zu is %g; expected a finite number", i + 1, seed[i]);
  if (lagrangian.reverse_sweep != NULL && lagrangian.reverse_sweep->is_for(instance, unknown, unknown_count))
    return reverse_derivative(instance, unknown, unknown_count, known, known_count, seed, value);
  double *column = instance->memory.allocate(unknown_count + 1, sizeof *column);
  if (column == NULL) return reject_call(instance, "out of memory for the derivatives");
  enum Status status = STATUS_DONE;
  for (size_t j = 0; j < known_count && status == STATUS_DONE; j++)
    status = weighted_column(instance, unknown, unknown_count, known[j], seed, column, &value[j]);
  instance->memory.free(column);
  return status;
}

enum Status derivatives_in_time(struct Instance *instance, const unsigned *reference, size_t count, double *value) {
  struct Point point = instance_point(instance);
  struct Direction direction = direction_create(instance);
  direction.seed.time = 1.0;
  direction.seed.input = instance->input_derivatives;
  if (lagrangian.derivatives != NULL && !evaluate_derivatives(instance, &point, direction.state))
    return discard_for_singularity(instance);
  enum Status status = follow(instance, &point, &direction);
  if (status != STATUS_DONE) return status;
  return read_along(instance, &point, &direction, reference, count, value);
}
