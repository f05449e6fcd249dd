/*
 * Coulomb friction in planes. While it slides its force is kinetic, against the velocity u; while it sticks its force
 * is |f| <= stiction. The zero u = 0 of a velocity in a plane cannot be located by a sign. Therefore a friction is
 * tried to stick once its speed falls to a small value that depends on the tolerance. Beyond its stiction it slips
 * along a direction d, with the force against d, until the velocity moves away from d; then it slides again.
 * plane_rests.c finds at once which of the frictions at rest stick, and along which directions the others slip.
 *
 * Each round makes one change, or one to each of several frictions. A friction may switch more than TOGETHER_LIMIT
 * times, or no forces may be found with the closed contacts. Then open contacts take part too, at most once in an event
 * resolution. Beyond SHORT_STEP_LIMIT switches a short step is tried (end_slip.h). If that fails, the motion ends with a
 * message.
 */
#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/frictions/frictions.h"
#include "nonsmooth/frictions/jams.h"
#include "evaluation/evaluate.h"
#include "nonsmooth/planes/plane_rests.h"

/*
 * Acceleration across the slip direction that counts as 0, in rounding errors of the last solution. plane_rests.c lets
 * frictions slip within a margin of 100 rounding errors to their limit.
 */
static const double in_rounding_error = 200.0;

/* Switches of one friction after which all forces at rest are solved for at once; and after which a step is tried. */
enum { TOGETHER_LIMIT = 20, SHORT_STEP_LIMIT = 40 };

static const char *reject_directions(const struct Resolution *resolution) {
  frictions_report_missing(resolution, "directions");
  return "the slip directions of frictions in a plane cannot be found";
}

/* True if a sliding friction needs other bounds on its speed, or another slip direction. */
static bool is_sliding_otherwise(const struct Resolution *resolution, const struct PlaneState *state) {
  if (state->is_first && (resolution->occasion == AT_START || state->has_slowed)) return true;
  if (state->is_first && state->has_sped && state->mode != PLANE_SLIDES) return true;
  if (plane_has_direction(state)) return state->ahead <= -state->lower || state->aside >= state->upper;
  if (state->mode == PLANE_CREEPS && (state->speed >= state->upper || state->ahead <= 0.0)) return true;
  return state->speed <= state->lower || (state->mode == PLANE_SLIDES && state->ahead < state->upper);
}

/* True if a friction that begins to slide does not accelerate along its direction. */
static bool slips_otherwise(const struct Resolution *resolution, const struct PlaneState *state) {
  if (!plane_has_direction(state) || plane_moves(state)) return false;
  size_t slot = friction_slot(resolution->switches, state->metadata->along, FRICTION_RATE);
  double c = mode_of(resolution, state->metadata->slip_direction[0]),
         s = mode_of(resolution, state->metadata->slip_direction[1]);
  double ahead = c * state->rate[0] + s * state->rate[1], aside = c * state->rate[1] - s * state->rate[0];
  double bound = fmax(in_rounding_error * resolution->least_acceleration,
                      resolution->error_bound[slot] + resolution->error_bound[slot + FRICTION_VALUES]);
  return ahead < -bound || fabs(aside) > bound;
}

/* True if a prescribed velocity leaves rest, or passes through it. */
static bool departs(const struct Resolution *resolution, const struct PlaneState *state) {
  const double *error_bound =
      &resolution->error_bound[friction_slot(resolution->switches, state->metadata->along, FRICTION_RATE)];
  bool speeds = state->velocity[0] * state->rate[0] + state->velocity[1] * state->rate[1] >= 0.0;
  bool has_rate = fabs(state->rate[0]) > error_bound[0] || fabs(state->rate[1]) > error_bound[FRICTION_VALUES];
  return (state->has_slowed && state->is_first) || state->speed > state->lower || (speeds && has_rate);
}

/* Handles a friction with a prescribed velocity: at rest it has no force, else it slides. True if its mode changes. */
static bool follow_given(struct Resolution *resolution, const struct PlaneState *state) {
  if (state->mode == PLANE_STICKS) {
    if (!departs(resolution, state)) return false;
    if (plane_moves(state)) plane_slide(resolution, state);
    else plane_slip(resolution, state, state->rate);
  } else {
    if (!plane_is_stopping(resolution, state) && !is_sliding_otherwise(resolution, state)) return false;
    if (plane_moves(state)) plane_slide(resolution, state);
    else plane_stick(resolution, state);
  }
  plane_count_switch(resolution, state);
  return true;
}

/* Handles a friction that loses its force, or has one again. True if its mode changes. */
static bool change_force(struct Resolution *resolution, const struct PlaneState *state) {
  if ((state->mode == PLANE_IS_FREE) != state->has_force) return false;
  if (!state->has_force) plane_free(resolution, state);
  else if (plane_moves(state)) plane_slide(resolution, state);
  else plane_stick(resolution, state);
  plane_count_switch(resolution, state);
  return true;
}

/* Handles all that lose their force, or have one again. True if a mode changes. */
static bool change_forces(struct Resolution *resolution) {
  bool changes = false;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    changes |= change_force(resolution, &state);
  }
  return changes;
}

/* Lets a friction slide with new bounds and another direction, or from rest if it has a velocity. True if it does. */
static bool change_slide(struct Resolution *resolution, const struct PlaneState *state) {
  if (state->mode == PLANE_STICKS ? state->speed <= state->small : !is_sliding_otherwise(resolution, state))
    return false;
  plane_slide(resolution, state);
  plane_count_switch(resolution, state);
  return true;
}

/* Returns a friction that has switched more often than the given number; friction_count for none. */
static size_t find_flipping(const struct Resolution *resolution, double often) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (resolution->flips[friction_indicator(switches, i)] > often) return i;
  return switches->friction_count;
}

/* True if a friction along a line needs more than its stiction. */
static bool any_is_overcome(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->friction_count; i++) any |= friction_is_overcome(resolution, i);
  return any;
}

/*
 * True if a friction along a line acts with its limit at rest, and is reported as sticking since others hold its velocity.
 * With other forces of contacts it may have a reserve.
 */
static bool any_rests_at_limit(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->friction_count && resolution->switches->rests_on != NULL; i++)
    any |= mode_of(resolution, resolution->switches->frictions[i].reported) == 0.0 &&
           friction_rests_at_limit(resolution, i);
  return any;
}

static const char *act_on_planes(struct Resolution *resolution, bool *again) {
  bool resolves = any_is_overcome(resolution);
  *again = false;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (state.mode == PLANE_IS_FREE) continue;
    if (state.is_given) *again |= follow_given(resolution, &state);
    else if (plane_is_stopping(resolution, &state) || plane_is_overcome(resolution, &state) ||
             slips_otherwise(resolution, &state) || plane_is_unheld(resolution, &state) ||
             plane_is_lost(resolution, &state))
      resolves = true;
    else *again |= change_slide(resolution, &state);
  }
  if (*again) return NULL;
  *again = resolves || (any_rests_at_limit(resolution) && plane_rests_find_with_contacts(resolution));
  if (!resolves) return NULL;
  bool is_found = plane_rests_find(resolution) || plane_rests_find_with_contacts(resolution);
  return is_found || resolution_ends_slip(resolution) ? NULL : reject_directions(resolution);
}

/* Finds the modes of frictions that keep switching. False if none does, or none are found. */
static bool end_round_trips(struct Resolution *resolution) {
  return find_flipping(resolution, TOGETHER_LIMIT) < resolution->switches->friction_count &&
         plane_rests_find_with_contacts(resolution);
}

static const char *act(struct Resolution *resolution, bool *again) {
  const char *problem = NULL;
  *again = change_forces(resolution);
  if (!*again) problem = frictions_act(resolution, again);
  if (problem == NULL && !*again && end_round_trips(resolution)) *again = true;
  else if (problem == NULL && !*again) problem = act_on_planes(resolution, again);
  size_t flipping = find_flipping(resolution, SHORT_STEP_LIMIT);
  if (problem != NULL || flipping == resolution->switches->friction_count) return problem;
  *again = jams_resolve(resolution) || resolution_ends_slip(resolution);
  return *again ? NULL : frictions_report_inconsistent(resolution, flipping);
}

static void set_plane(struct Resolution *resolution, size_t plane, bool slides) {
  struct PlaneState state = plane_state(resolution, plane);
  const double slip_direction[] = {mode_of(resolution, state.metadata->slip_direction[0]),
                                   mode_of(resolution, state.metadata->slip_direction[1])};
  if (!slides) plane_stick(resolution, &state);
  else if (plane_moves(&state)) plane_slide(resolution, &state);
  else plane_slip(resolution, &state, slip_direction);
}

static bool is_slow(const struct Resolution *resolution, size_t plane) {
  struct PlaneState state = plane_state(resolution, plane);
  return plane_is_slow(resolution, &state);
}

/* Sets the modes before the first resolution: free, or sliding at a velocity. The first axis is the slip direction. */
static void guess(struct Instance *instance) {
  struct Resolution resolution = resolution_of(instance);
  const struct SwitchTable *switches = resolution.switches;
  struct Point point = instance_point(instance);
  double *parameter = instance->parameter;
  for (size_t i = 0; i < switches->plane_count; i++) {
    const struct PlaneState state = {.metadata = &switches->planes[i]};
    plane_free(&resolution, &state);
    parameter[state.metadata->slip_direction[0]] = 1.0;
    parameter[state.metadata->slip_direction[1]] = 0.0;
  }
  size_t rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  memset(resolution.acceleration, 0, rows * sizeof *resolution.acceleration);
  if (lagrangian.prepare(parameter, instance->parameter_constants) != 0) return;
  switches->switching_values(&point, resolution.acceleration, resolution.value);
  for (size_t i = 0; i < switches->plane_count; i++) {
    size_t along = switches->planes[i].along;
    if (speed_in_plane(&resolution, along) > 0.0) parameter[switches->frictions[along].mode] = PLANE_SLIDES;
  }
}

const struct FrictionLaws plane_friction_laws = {.slide_unheld = frictions_slide_unheld,
                                                 .act = act,
                                                 .report = frictions_report,
                                                 .report_missing = frictions_report_missing,
                                                 .check = frictions_check,
                                                 .release = frictions_release,
                                                 .resolve_jam = jams_resolve,
                                                 .explain_jam = frictions_explain_jam,
                                                 .guess = guess,
                                                 .resolve_together = plane_rests_find_with_contacts,
                                                 .continue_together = plane_rests_continue,
                                                 .slip_where_stopped = let_stopped_slip,
                                                 .is_slow = is_slow,
                                                 .set_plane = set_plane};
