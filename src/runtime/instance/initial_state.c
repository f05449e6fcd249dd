#include "instance/initial_state.h"

#include <math.h>

/* Returns the variable at an index of lagrangian.following. */
static const struct ScalarVariable *variable_at(size_t following) {
  return &lagrangian.variables[lagrangian.following[following]];
}

/* Returns the value of a state or mode in arrays of states and parameters. */
static double *value_in(double *state, double *parameter, const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_STATE ? &state[variable->index] : &parameter[variable->index];
}

void initial_state_set(struct Instance *instance, const struct ScalarVariable *variable) {
  for (size_t i = 0; i < lagrangian.following_count; i++)
    if (variable_at(i) == variable) instance->start_was_set[i] = 1.0;
}

void initial_state_follow(struct Instance *instance) {
  if (lagrangian.following_count == 0) return;
  struct Point point = instance_point(instance);
  lagrangian.initial_state(&point, instance->start_work);
  for (size_t i = 0; i < lagrangian.following_count; i++)
    if (instance->start_was_set[i] == 0.0)
      *value_in(instance->state, instance->parameter, variable_at(i)) = instance->start_work[i];
}

void initial_state_add_along(struct Instance *instance, double *state, double *parameter) {
  if (lagrangian.following_count == 0 || !is_before_start(instance)) return;
  struct Point point = instance_point(instance);
  lagrangian.initial_state_along(&point, &(struct Seed){.parameter = parameter}, instance->start_work);
  for (size_t i = 0; i < lagrangian.following_count; i++)
    if (instance->start_was_set[i] == 0.0) *value_in(state, parameter, variable_at(i)) += instance->start_work[i];
}

enum Status initial_state_check(struct Instance *instance) {
  for (size_t i = 0; i < lagrangian.following_count; i++) {
    const struct ScalarVariable *variable = variable_at(i);
    if (instance->start_was_set[i] == 0.0 && !isfinite(*value_in(instance->state, instance->parameter, variable)))
      return reject_call(instance,
                         "the start value of '%s' is not finite: it follows from %s; set these otherwise, or '%s' "
                         "itself",
                         variable->name, variable->follows_from, variable->name);
  }
  return STATUS_DONE;
}
