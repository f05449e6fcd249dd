#include "fmi/reverse_sweep.h"

#include <math.h>

#include "evaluation/evaluate.h"
#include "fmi/check.h"
#include "instance/initial_state.h"
#include "support/arena.h"

/* Parts of one block of memory: weights of derivatives, results and states, and the gradient of the weighted sum. */
struct Weights {
  double *derivative, *result, *state, *gradient;
};

static size_t lay_out_weights(struct Weights *weights, void *block) {
  size_t states = lagrangian.state_count, knowns = states + lagrangian.input_count + lagrangian.parameter_count + 1;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, states, &weights->derivative, &weights->state);
  ARENA_NUMBERS(&arena, lagrangian.results.count, &weights->result);
  ARENA_NUMBERS(&arena, knowns, &weights->gradient);
  return arena.next - (uintptr_t)block;
}

static bool is_for(const struct Instance *instance, const unsigned *unknown, size_t unknown_count) {
  bool is = !is_before_start(instance);
  for (size_t i = 0; i < unknown_count && lagrangian.constraints.count > 0; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[unknown[i]];
    bool is_result = unknown[i] < lagrangian.variable_count && variable->kind == VARIABLE_RESULT;
    is &= !(is_result && lagrangian.results.uses_acceleration[variable->index]);
  }
  return is;
}

static enum Status add_weight(struct Instance *instance, const struct Weights *weights, unsigned reference,
                              double seed) {
  const struct ScalarVariable *variable = check_reference(instance, reference, TYPE_REAL);
  if (variable == NULL) return STATUS_ERROR;
  if (!is_unknown(variable))
    return reject_call(instance, "'%s' is not an unknown; expected an output or a state derivative", variable->name);
  double *weight = variable->kind == VARIABLE_DERIVATIVE ? weights->derivative
                   : variable->kind == VARIABLE_STATE    ? weights->state
                                                         : weights->result;
  weight[variable->index] += seed;
  return STATUS_DONE;
}

static enum Status read_known(struct Instance *instance, const struct Weights *weights, unsigned reference,
                              double *value) {
  const struct ScalarVariable *variable = check_reference(instance, reference, TYPE_REAL);
  if (variable == NULL) return STATUS_ERROR;
  const double *inputs = weights->gradient + lagrangian.state_count, *parameters = inputs + lagrangian.input_count;
  switch (variable->kind) {
  case VARIABLE_STATE: *value = weights->gradient[variable->index] + weights->state[variable->index]; break;
  case VARIABLE_INPUT: *value = inputs[variable->index]; break;
  case VARIABLE_PARAMETER: *value = parameters[variable->index]; break;
  case VARIABLE_TIME: *value = parameters[lagrangian.parameter_count]; break;
  default:
    return reject_call(instance, "'%s' is not a known; expected a state, an input or a parameter", variable->name);
  }
  if (isfinite(*value)) return STATUS_DONE;
  return discard_call(instance, "the derivative by '%s' is not finite", variable->name);
}

static enum Status sweep(struct Instance *instance, const struct Weights *weights) {
  enum Status status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  struct Point point = evaluate_point(instance);
  struct Seed seed = {.state = weights->derivative, .result = weights->result};
  instance->singular = lagrangian.weighted_gradient(&point, &seed, weights->gradient);
  return instance->singular == 0 ? STATUS_DONE : discard_for_singularity(instance);
}

static enum Status derivative_by_sweep(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                       const unsigned *known, size_t known_count, const double *seed, double *value) {
  struct Weights weights;
  void *block = instance->memory.allocate(1, lay_out_weights(&weights, NULL));
  if (block == NULL) return reject_call(instance, "out of memory for the derivatives");
  lay_out_weights(&weights, block);
  enum Status status = STATUS_DONE;
  for (size_t i = 0; i < unknown_count && status == STATUS_DONE; i++)
    status = add_weight(instance, &weights, unknown[i], seed[i]);
  if (status == STATUS_DONE) status = sweep(instance, &weights);
  for (size_t j = 0; j < known_count && status == STATUS_DONE; j++)
    status = read_known(instance, &weights, known[j], &value[j]);
  instance->memory.free(block);
  return status;
}

const struct ReverseSweep reverse_sweep = {is_for, derivative_by_sweep};
