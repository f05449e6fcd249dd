#include "lane_events.h"

#include <stdlib.h>

#include "detection/chebyshev.h"
#include "support/arena.h"

bool lane_events_are_needed(void) {
  return single_run_is_needed();
}

static size_t lay_out_events(struct LaneEvents *events, Lanes *block) {
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, lagrangian.coordinate_count + lagrangian.constraints.count, &events->acceleration);
  ARENA_NUMBERS(&arena, CHEBYSHEV_NODES * indicator_count(lagrangian.switches), &events->indicator);
  return (arena.next - (uintptr_t)block) / sizeof(Lanes);
}

bool lane_events_create(struct LaneEvents *events, struct LaneSteps *steps) {
  *events = (struct LaneEvents){.steps = steps};
  if (!lane_events_are_needed()) return true;
  events->run = single_run_create(LANES, steps->tolerance, steps->length);
  Lanes *block = lane_rows(lay_out_events(events, NULL), &events->memory);
  if (events->run == NULL || block == NULL) {
    lane_events_destroy(events);
    return false;
  }
  lay_out_events(events, block);
  return true;
}

void lane_events_destroy(struct LaneEvents *events) {
  single_run_destroy(events->run);
  free(events->memory);
}

static struct LaneView view_of(const struct LaneSteps *steps, int lane) {
  return (struct LaneView){.number = (size_t)lane,
                           .stride = LANES,
                           .order = (int)steps->step.order,
                           .origin = steps->origin[lane],
                           .interval = steps->interval[lane],
                           .series = (double *)steps->step.x + lane,
                           .low = (double *)steps->step.low + lane,
                           .parameter = (double *)steps->parameter + lane,
                           .parameter_constants = (double *)steps->parameter_constants + lane,
                           .input = (double *)steps->constants + lane};
}

Mask lane_events_start(struct LaneEvents *events, Mask lanes) {
  Mask lost = {0};
  for (int i = 0; i < LANES; i++) {
    if (!lanes[i]) continue;
    struct LaneView view = view_of(events->steps, i);
    lost[i] = single_run_start(events->run, &view) ? 0 : -1;
  }
  return lost;
}

/*
 * --- Test for events
 * --------------------------------------------------------------------------------------------------
 */

/* Returns the lanes in which a contact is closed or a friction sticks. */
static Mask are_touched(const struct LaneSteps *steps) {
  const struct SwitchTable *switches = lagrangian.switches;
  Mask touched = {0};
  if (switches == NULL) return touched;
  for (size_t i = 0; i < switches->contact_count; i++) touched |= steps->parameter[switches->contacts[i].mode] > 0.0;
  for (size_t i = 0; i < switches->friction_count; i++) touched |= steps->parameter[switches->frictions[i].mode] == 0.0;
  return touched;
}

Mask lane_events_accelerations(struct LaneEvents *events, Lanes time) {
  struct LaneSteps *steps = events->steps;
  struct Point point = lane_steps_point(steps, time);
  failed_lanes = (Mask){0};
  lagrangian.constraints.accelerations(&point, events->acceleration);
  return failed_lanes;
}

/* Evaluates the indicators at a time. Returns the lanes in which that fails. */
static Mask evaluate_indicators(struct LaneEvents *events, Lanes time, bool feels_forces, Lanes *indicator) {
  struct LaneSteps *steps = events->steps;
  lane_steps_take_state(steps, time);
  Mask failed = feels_forces ? lane_events_accelerations(events, time) : (Mask){0};
  struct Point point = lane_steps_point(steps, time);
  lagrangian.switches->indicators(&point, events->acceleration, indicator);
  return failed;
}

/*
 * Returns the lanes in which a function stays positive, from its values f at the Chebyshev nodes; see
 * search_judge() of detection/search.c. The interpolant is the sum of c_k T_k with |T_k| <= 1. It is positive if c_0
 * exceeds the sum of the other |c_k| and the tail, which bounds the interpolation error. It is also positive
 * between nonnegative ends, if it is monotone or concave by the same bound on a derivative.
 */
static Mask stay_positive(const Lanes *f) {
  Lanes c[CHEBYSHEV_NODES], d[CHEBYSHEV_NODES], curvature[CHEBYSHEV_NODES];
  chebyshev_coefficients(f, c);
  Lanes tail = chebyshev_tail(c);
  chebyshev_derivative(c, d);
  chebyshev_derivative(d, curvature);
  Mask is_far = c[0] - chebyshev_range(c) > 2.0 * tail;
  Mask is_resolved = tail <= chebyshev_resolved * chebyshev_range(c);
  Mask rises = d[0] - chebyshev_range(d) > chebyshev_tail_of_derivative * tail;
  Mask is_concave = -curvature[0] - chebyshev_range(curvature) > chebyshev_tail_of_curvature * tail;
  Mask ends_positive = (f[CHEBYSHEV_DEGREE] >= 0.0) & (f[0] >= 0.0);
  return is_far | (is_resolved & (rises | (is_concave & ends_positive)));
}

/* Returns the sign of an indicator in the present mode, as indicator_sign() of detection/indicators.c. */
static Lanes sign_of(const struct LaneSteps *steps, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_branch = indicator < switches->branch_count;
  return is_branch ? steps->parameter[switches->branches[indicator].mode] : LANES_OF(1.0);
}

/* Returns the lanes that certainly have no event between two times. None if narrow features may hide events. */
static Mask are_quiet(struct LaneEvents *events, Lanes from, Lanes to) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t count = indicator_count(switches);
  Mask quiet = ~(Mask){0};
  if (switches->watched_limit != NULL) return (Mask){0};
  bool feels_forces = switches->feels_forces || any_lane(are_touched(events->steps));
  for (int node = 0; node < CHEBYSHEV_NODES; node++)
    quiet &= ~evaluate_indicators(events, chebyshev_time(from, to, node), feels_forces,
                                  events->indicator + (size_t)node * count);
  for (size_t i = 0; i < count && any_lane(quiet); i++) {
    Lanes f[CHEBYSHEV_NODES], sign = sign_of(events->steps, i);
    for (size_t node = 0; node < CHEBYSHEV_NODES; node++) f[node] = sign * events->indicator[node * count + i];
    quiet &= stay_positive(f);
  }
  return quiet;
}

Mask lane_events_find(struct LaneEvents *events, Mask active) {
  struct LaneSteps *steps = events->steps;
  Mask lost = {0};
  Lanes from = steps->origin;
  events->happens = (Mask){0};
  events->time = steps->origin + steps->interval;
  if (lagrangian.switches == NULL) return lost;
  for (int i = 0; i < LANES; i++)
    if (active[i]) from[i] = single_run_searched(events->run, (size_t)i);
  Mask quiet = are_quiet(events, from, lanes_smaller(events->time, LANES_OF(steps->length)));
  for (int i = 0; i < LANES; i++) {
    if (!active[i]) continue;
    struct LaneView view = view_of(steps, i);
    double time = events->time[i];
    enum LaneEvent event = NO_EVENT;
    if (quiet[i]) single_run_pass_quietly(events->run, &view);
    else event = single_run_find_event(events->run, &view, &time);
    lost[i] = event == EVENT_UNKNOWN ? -1 : 0;
    events->happens[i] = event == EVENT ? -1 : 0;
    events->time[i] = time;
  }
  return lost;
}

/* --- Constraints ------------------------------------------------------------------------------------------------------ */

/* Returns the lanes in which a constraint is closed. */
static Mask have_active_constraints(const struct LaneSteps *steps) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t of_switches = switches != NULL ? switches->contact_count + switches->friction_count : 0;
  return lagrangian.constraints.count > of_switches ? ~(Mask){0} : are_touched(steps);
}

Mask lane_events_continue(struct LaneEvents *events, Mask active) {
  struct LaneSteps *steps = events->steps;
  Mask lost = {0}, happens = events->happens & active;
  for (int i = 0; i < LANES; i++) {
    if (!happens[i]) continue;
    struct LaneView view = view_of(steps, i);
    single_run_continue(events->run, &view);
  }
  steps->origin = lanes_select(happens, events->time, steps->origin);
  Mask constrained = have_active_constraints(steps) & active;
  if (any_lane(happens)) lagrangian.prepare(steps->parameter, steps->parameter_constants);
  for (int i = 0; i < LANES; i++) {
    if (!constrained[i]) continue;
    struct LaneView view = view_of(steps, i);
    lost[i] = single_run_keep_constraints(events->run, &view) ? 0 : -1;
  }
  if (any_lane(happens | constrained)) lost |= lane_steps_start(steps);
  return lost & active;
}

Mask lane_events_project(struct LaneEvents *events, Lanes time, Mask lanes) {
  struct LaneSteps *steps = events->steps;
  Mask lost = {0}, constrained = have_active_constraints(steps) & lanes;
  for (int i = 0; i < LANES; i++) {
    if (!constrained[i]) continue;
    struct LaneView view = view_of(steps, i);
    lost[i] = single_run_project(events->run, &view, time[i], (double *)steps->step.state + i) ? 0 : -1;
  }
  return lost;
}

Mask lane_events_check_end(struct LaneEvents *events, Lanes time, Mask lanes) {
  struct LaneSteps *steps = events->steps;
  Mask fails = {0};
  if (lagrangian.switches == NULL) return fails;
  for (int i = 0; i < LANES; i++) {
    if (!lanes[i]) continue;
    struct LaneView view = view_of(steps, i);
    fails[i] = single_run_may_end(events->run, &view, time[i], (double *)steps->step.state + i) ? 0 : -1;
  }
  return fails;
}
