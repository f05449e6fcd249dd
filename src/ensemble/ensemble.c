#include "ensemble.h"

#include "lane_events.h"
#include "lane_steps.h"

/* The runs that are in the lanes, and those to come. */
struct LaneGroup {
  const struct Ensemble *ensemble;
  struct LaneSteps steps;
  struct LaneEvents events;
  Mask is_active;
  size_t run[LANES], time[LANES]; /* of each active lane: its run, and the index of its next sampling time */
  size_t next, end;               /* the runs to come */
};

static void set_lane(struct LaneSteps *steps, const struct ScalarVariable *variable, int lane, double value) {
  if (variable->kind == VARIABLE_STATE) steps->step.x[variable->index][0][lane] = value;
  if (variable->kind == VARIABLE_INPUT) steps->constants[variable->index][lane] = value;
  if (variable->kind == VARIABLE_PARAMETER || variable->kind == VARIABLE_MODE)
    steps->parameter[variable->index][lane] = value;
}

/* True if the FMU would accept the value. */
static bool is_allowed(const struct ScalarVariable *variable, double value) {
  return isfinite(value) && value >= variable->minimum && value <= variable->maximum;
}

static void release_lanes(struct LaneGroup *group, Mask lanes) {
  for (int i = 0; any_lane(lanes) && i < LANES; i++)
    if (lanes[i]) group->ensemble->needs_fmu[group->run[i]] = true;
  group->is_active &= ~lanes;
}

/* Loads the next run into a lane. */
static void load_run(struct LaneGroup *group, int lane) {
  const struct Ensemble *ensemble = group->ensemble;
  struct LaneSteps *steps = &group->steps;
  size_t run = group->next++;
  bool is_right = true;
  for (size_t i = 0; i < lagrangian.variable_count; i++)
    set_lane(steps, &lagrangian.variables[i], lane, lagrangian.variables[i].start);
  for (size_t i = 0; i < ensemble->varied_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[ensemble->varied[i]];
    double value = ensemble->start[run * ensemble->varied_count + i];
    set_lane(steps, variable, lane, value);
    is_right &= is_allowed(variable, value);
  }
  for (size_t i = 0; i < lagrangian.state_count; i++) steps->step.low[i][lane] = 0.0;
  steps->origin[lane] = steps->interval[lane] = 0.0;
  steps->fast[lane] = steps->path[lane] = steps->steps[lane] = 0.0;
  group->run[lane] = run;
  group->time[lane] = 0;
  group->is_active[lane] = is_right ? -1 : 0;
  ensemble->needs_fmu[run] = !is_right;
}

/* Computes start values that are expressions of parameters, except those that vary themselves. */
static void set_following_starts(struct LaneGroup *group, Mask lanes) {
  const struct Ensemble *ensemble = group->ensemble;
  struct LaneSteps *steps = &group->steps;
  struct Point point = {.parameter = steps->parameter, .work = steps->point_work};
  if (lagrangian.following_count == 0) return;
  lagrangian.initial_state(&point, steps->start);
  for (size_t i = 0; i < lagrangian.following_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[lagrangian.following[i]];
    bool follows = true;
    for (size_t j = 0; j < ensemble->varied_count; j++) follows &= ensemble->varied[j] != lagrangian.following[i];
    Lanes *value =
        variable->kind == VARIABLE_STATE ? steps->step.x[variable->index] : &steps->parameter[variable->index];
    if (follows) *value = lanes_select(lanes, steps->start[i], *value);
  }
}

/* Loads runs into free lanes, until all are active or no run is left. */
static void load_runs(struct LaneGroup *group) {
  Mask is_new;
  do {
    is_new = ~group->is_active;
    for (int i = 0; i < LANES; i++)
      while (!group->is_active[i] && group->next < group->end) load_run(group, i);
    is_new &= group->is_active;
    if (!any_lane(is_new)) return;
    set_following_starts(group, is_new);
    if (lane_events_are_needed()) release_lanes(group, lane_events_start(&group->events, is_new));
    release_lanes(group, lane_steps_start(&group->steps) & is_new);
  } while (any_lane(~group->is_active) && group->next < group->end);
}

/* Returns the lanes whose next sampling time lies before their event, or else in their step; time: these times. */
static Mask find_sampled(const struct LaneGroup *group, Lanes *time) {
  const double *times = group->ensemble->times;
  Lanes end = group->steps.origin + group->steps.interval;
  Mask is_reached = {0};
  for (int i = 0; i < LANES; i++) {
    double next = times[group->time[i]];
    bool is_before = group->events.happens[i] ? next < group->events.time[i] : next <= end[i];
    if (!group->is_active[i] || !is_before) continue;
    (*time)[i] = next;
    is_reached[i] = -1;
  }
  return is_reached;
}

/* True if a run can vary, or sample, the variable. */
static bool can_vary(const struct ScalarVariable *variable) {
  bool is_start = variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_INPUT;
  return variable->type == TYPE_REAL && (is_start || variable->kind == VARIABLE_PARAMETER);
}

static bool can_report(const struct ScalarVariable *variable) {
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

/* Returns the accelerations for result(), at steps->step.state; *is_lost: lanes without. */
static const Lanes *accelerations(struct LaneEvents *events, Lanes time, Mask *is_lost) {
  struct LaneSteps *steps = events->steps;
  if (lagrangian.constraints.accelerations != NULL) {
    *is_lost = lane_events_accelerations(events, time);
    return events->acceleration;
  }
  struct Point point = lane_steps_point(steps, time);
  failed_lanes = (Mask){0};
  lagrangian.derivatives(&point, steps->step.rate);
  *is_lost = failed_lanes;
  return steps->step.rate + lagrangian.coordinate_count;
}

/*
 * Samples the recorded variables at a time of each lane and at steps->step.state, in the reached lanes. run, slot: of
 * each lane, the run and the index of the time. Returns the lanes in which a value is not finite.
 */
static Mask report_values(const struct Ensemble *ensemble, struct LaneEvents *events, Lanes time, Mask is_reached,
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

/* Samples values at all times within the steps. A run ends at the last time. */
static void report_samples(struct LaneGroup *group) {
  const struct Ensemble *ensemble = group->ensemble;
  for (;;) {
    Lanes time = group->steps.origin;
    Mask is_reached = find_sampled(group, &time), is_over = {0};
    if (!any_lane(is_reached)) return;
    lane_steps_take_state(&group->steps, time);
    Mask is_lost = lane_events_project(&group->events, time, is_reached);
    is_lost |= report_values(ensemble, &group->events, time, is_reached, group->run, group->time);
    for (int i = 0; i < LANES; i++)
      if (is_reached[i] && ++group->time[i] == ensemble->time_count) is_over[i] = -1;
    release_lanes(group, is_lost | lane_events_check_end(&group->events, time, is_over));
    group->is_active &= ~is_over;
  }
}

bool ensemble_supports(const struct Ensemble *ensemble) {
  bool is_supported = lagrangian.steps.max_steps == 0 && lagrangian.constraints.prescribed_input_count == 0;
  for (size_t i = 0; i < ensemble->varied_count; i++)
    is_supported &= can_vary(&lagrangian.variables[ensemble->varied[i]]);
  for (size_t i = 0; i < ensemble->recorded_count; i++)
    is_supported &= can_report(&lagrangian.variables[ensemble->recorded[i]]);
  return is_supported;
}

bool ensemble_run(const struct Ensemble *ensemble, size_t first, size_t count) {
  struct LaneGroup group = {.ensemble = ensemble, .next = first, .end = first + count};
  double tolerance = ensemble->tolerance > 0.0 ? ensemble->tolerance : lagrangian.steps.tolerance;
  if (!lane_steps_create(&group.steps, tolerance, ensemble->times[ensemble->time_count - 1])) return false;
  bool has_memory = lane_events_create(&group.events, &group.steps);
  if (has_memory) load_runs(&group);
  for (; has_memory && any_lane(group.is_active); load_runs(&group)) {
    release_lanes(&group, lane_steps_expand(&group.steps, group.is_active));
    release_lanes(&group, lane_events_find(&group.events, group.is_active));
    report_samples(&group);
    release_lanes(&group, lane_steps_move(&group.steps) & group.is_active);
    release_lanes(&group, lane_events_continue(&group.events, group.is_active));
  }
  lane_events_destroy(&group.events);
  lane_steps_destroy(&group.steps);
  return has_memory;
}
