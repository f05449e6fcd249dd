#include "lane_values.h"

bool lane_values_can_vary(const struct ScalarVariable *variable) {
  bool is_start = variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_INPUT;
  return variable->type == TYPE_REAL && (is_start || variable->kind == VARIABLE_PARAMETER);
}

bool lane_values_can_tell(const struct ScalarVariable *variable) {
  return variable->type == TYPE_REAL && (variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_RESULT);
}

static Lanes value_of(const struct ScalarVariable *variable, const struct Point *point, const Lanes *derivative) {
  if (variable->kind == VARIABLE_STATE) return point->state[variable->index];
  return lagrangian.results.result(point, derivative + lagrangian.coordinate_count, variable->index);
}

static bool asks_for_accelerations(const struct Ensemble *ensemble) {
  for (size_t i = 0; i < ensemble->asked_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[ensemble->asked[i]];
    if (variable->kind == VARIABLE_RESULT && lagrangian.results.uses_acceleration[variable->index]) return true;
  }
  return false;
}

Mask lane_values_tell(const struct Ensemble *ensemble, const struct LaneSteps *steps, Lanes time, Mask is_reached,
                      const size_t *run, const size_t *place) {
  struct Point point = {.time = time,
                        .state = steps->state,
                        .input = steps->constants,
                        .parameter = steps->parameter,
                        .prepared = steps->prepared};
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->state[i] = lane_steps_state(steps, i, time);
  lanes_refused = (Mask){0};
  if (asks_for_accelerations(ensemble)) lagrangian.derivatives(&point, steps->rate);
  Mask is_lost = lanes_refused;
  for (size_t i = 0; i < ensemble->asked_count; i++) {
    Lanes value = value_of(&lagrangian.variables[ensemble->asked[i]], &point, steps->rate);
    is_lost |= ~lanes_are_finite(value);
    for (int j = 0; j < LANES; j++)
      if (is_reached[j])
        ensemble->values[(run[j] * ensemble->time_count + place[j]) * ensemble->asked_count + i] = value[j];
  }
  return is_lost & is_reached;
}
