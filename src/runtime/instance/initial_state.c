#include "instance/initial_state.h"

#include <math.h>

/* True if the value of the state follows from the parameters. */
static bool follows(const struct Instance *instance, const struct ScalarVariable *variable) {
  return has_following_start(variable) && instance->state_was_set[variable->index] == 0.0;
}

void initial_state_set(struct Instance *instance, size_t state) {
  if (lagrangian.initial_state != NULL) instance->state_was_set[state] = 1.0;
}

void initial_state_follow(struct Instance *instance) {
  if (lagrangian.initial_state == NULL) return;
  struct Point point = instance_point(instance);
  lagrangian.initial_state(&point, instance->work);
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (follows(instance, variable)) instance->state[variable->index] = instance->work[variable->index];
  }
}

void initial_state_add_along(struct Instance *instance, const double *parameter, double *state, double *scratch) {
  if (lagrangian.initial_state == NULL || !is_before_start(instance)) return;
  struct Point point = instance_point(instance);
  lagrangian.initial_state_along(&point, &(struct Seed){.parameter = parameter}, scratch);
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (follows(instance, variable)) state[variable->index] += scratch[variable->index];
  }
}

enum Status initial_state_check(struct Instance *instance) {
  for (size_t i = 0; lagrangian.initial_state != NULL && i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (follows(instance, variable) && !isfinite(instance->state[variable->index]))
      return reject_call(instance,
                         "the start value of '%s' is not finite: it follows from %s; set these otherwise, or '%s' "
                         "itself",
                         variable->name, variable->follows_from, variable->name);
  }
  return STATUS_DONE;
}
