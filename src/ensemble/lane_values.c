#include "lane_values.h"

bool lane_values_can_vary(const struct ScalarVariable *variable) {
  bool is_start = variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_INPUT;
  return variable->type == TYPE_REAL && (is_start || variable->kind == VARIABLE_PARAMETER);
}

bool lane_values_can_report(const struct ScalarVariable *variable) {
  return variable->type == TYPE_REAL && (variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_RESULT);
}

static Lanes value_of(const struct ScalarVariable *variable, const struct Point *point, const Lanes *acceleration) {
  if (variable->kind == VARIABLE_STATE) return point->state[variable->index];
  return lagrangian.results.result(point, acceleration, variable->index);
}

static bool asks_for_accelerations(const struct Ensemble *ensemble) {
  for (size_t i = 0; i < ensemble->recorded_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[ensemble->recorded[i]];
    if (variable->kind == VARIABLE_RESULT && lagrangian.results.uses_acceleration[variable->index]) return true;
  }
  return false;
}

/* Returns the accelerations for result(), at steps->state; *is_lost: lanes without. */
static const Lanes *accelerations(struct LaneEvents *events, Lanes time, Mask *is_lost) {
  struct LaneSteps *steps = events->steps;
  if (lagrangian.constraints.accelerations != NULL) {
    *is_lost = lane_events_accelerations(events, time);
    return events->acceleration;
  }
  struct Point point = lane_steps_point(steps, time);
  failed_lanes = (Mask){0};
  lagrangian.derivatives(&point, steps->rate);
  *is_lost = failed_lanes;
  return steps->rate + lagrangian.coordinate_count;
}

Mask lane_values_report(const struct Ensemble *ensemble, struct LaneEvents *events, Lanes time, Mask is_reached,
                        const size_t *run, const size_t *slot) {
  struct Point point = lane_steps_point(events->steps, time);
  Mask is_lost = {0};
  const Lanes *acceleration = asks_for_accelerations(ensemble) ? accelerations(events, time, &is_lost) : NULL;
  for (size_t i = 0; i < ensemble->recorded_count; i++) {
    Lanes value = value_of(&lagrangian.variables[ensemble->recorded[i]], &point, acceleration);
    is_lost |= ~lanes_are_finite(value);
    for (int j = 0; j < LANES; j++)
      if (is_reached[j])
        ensemble->values[(run[j] * ensemble->time_count + slot[j]) * ensemble->recorded_count + i] = value[j];
  }
  return is_lost & is_reached;
}
