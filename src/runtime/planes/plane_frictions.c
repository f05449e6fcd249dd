/*
 * Coulomb friction in planes. While it slides its force is kinetic, against the velocity u; while it sticks its force
 * is |f| <= stiction. The zero u = 0 of a velocity in a plane cannot be located by a sign. Therefore a friction is
 * tried to stick once its speed falls to a small value that depends on the tolerance (plane_stops.c). Beyond its
 * stiction it slips along a direction d (plane_starts.c), with the force against d, until the velocity moves away from
 * d; then it slides again. Sticking frictions share a load that does not determine their forces (plane_loads.c).
 *
 * Each round makes one change, or one to each of several frictions. If one switches more than TOGETHER_LIMIT times, or
 * stops or directions are not found, all forces at rest are solved for at once (plane_forces.c), once an event
 * resolution. Beyond FRICTION_FLIP_LIMIT switches the motion ends with a message.
 */
#include <math.h>
#include <string.h>

#include "contacts/frictions.h"
#include "contacts/jams.h"
#include "evaluation/evaluate.h"
#include "planes/cone_impulses.h"
#include "planes/plane_forces.h"
#include "planes/plane_loads.h"
#include "planes/plane_starts.h"
#include "planes/plane_stops.h"

/* Switches of one friction after which all forces at rest are solved for at once. */
enum { TOGETHER_LIMIT = 20 };

static const char *refuse_directions(const struct Settlement *settlement) {
  frictions_blame(settlement, "directions");
  return "the slip directions of frictions in a plane cannot be found";
}

/* True if a sliding friction has to be tried to stick. */
static bool is_stopping(const struct Settlement *settlement, const struct PlaneState *state) {
  bool has_slowed = state->has_slowed && state->is_first;
  if (state->mode == PLANE_STICKS || !plane_is_slow(settlement, state)) return false;
  if (settlement->occasion == AT_START && state->is_first) return true;
  if (state->mode == PLANE_SLIDES) return state->speed <= state->lower || has_slowed || state->has_turned_back;
  return state->mode == PLANE_HEADS && (state->ahead <= -state->lower || has_slowed);
}

/* True if a sliding friction needs other bounds on its speed, or another slip direction. */
static bool is_sliding_otherwise(const struct Settlement *settlement, const struct PlaneState *state) {
  double rising = state->mode == PLANE_HEADS ? state->aside : state->speed;
  if (settlement->occasion == AT_START && state->is_first) return true;
  if (state->upper > 0.0 && (rising >= state->upper || (state->has_sped && state->is_first))) return true;
  if (state->has_slowed && state->is_first) return true;
  if (state->mode == PLANE_HEADS) return state->ahead <= -state->lower;
  return state->speed <= state->lower || (state->upper < 0.0 && state->ahead <= state->upper);
}

/* True if a sticking friction needs more than its stiction. */
static bool is_overcome(const struct Settlement *settlement, const struct PlaneState *state) {
  bool is_reached = state->has_slowed && state->is_first && !settlement->jumped;
  return state->mode == PLANE_STICKS && (state->needed > state->stiction || is_reached);
}

/* Lets a sticking friction slide if it moves, as after an impact, or if it needs more than its stiction. True if so. */
static bool leave_rest(struct Settlement *settlement, const struct PlaneState *state) {
  if (!(state->speed > state->small || is_overcome(settlement, state))) return false;
  if (plane_moves(state)) plane_slide(settlement, state);
  else plane_head(settlement, state, state->force);
  plane_count_switch(settlement, state);
  return true;
}

/* True if a prescribed velocity leaves rest, or passes through it. */
static bool departs(const struct Settlement *settlement, const struct PlaneState *state) {
  const double *noise = &settlement->noise[friction_place(settlement->switches, state->facts->along, FRICTION_RATE)];
  bool speeds = state->velocity[0] * state->rate[0] + state->velocity[1] * state->rate[1] >= 0.0;
  bool has_rate = fabs(state->rate[0]) > noise[0] || fabs(state->rate[1]) > noise[FRICTION_VALUES];
  return (state->has_slowed && state->is_first) || state->speed > state->lower || (speeds && has_rate);
}

/* Handles a friction with a prescribed velocity: at rest it has no force, else it slides. True if its mode changes. */
static bool follow_given(struct Settlement *settlement, const struct PlaneState *state) {
  if (state->mode == PLANE_STICKS) {
    if (!departs(settlement, state)) return false;
    if (plane_moves(state)) plane_slide(settlement, state);
    else plane_head(settlement, state, state->rate);
  } else {
    if (!is_stopping(settlement, state) && !is_sliding_otherwise(settlement, state)) return false;
    if (plane_moves(state)) plane_slide(settlement, state);
    else plane_stick(settlement, state);
  }
  plane_count_switch(settlement, state);
  return true;
}

/* Handles a friction that loses its force, or has one again. True if its mode changes. */
static bool change_force(struct Settlement *settlement, const struct PlaneState *state) {
  if (state->is_free != state->has_force) return false;
  if (!state->has_force) plane_free(settlement, state);
  else if (plane_moves(state)) plane_slide(settlement, state);
  else plane_stick(settlement, state);
  plane_count_switch(settlement, state);
  return true;
}

/* Updates the bounds and the direction of a sliding friction. True if it had to. */
static bool change_slide(struct Settlement *settlement, const struct PlaneState *state) {
  if (!is_sliding_otherwise(settlement, state)) return false;
  plane_slide(settlement, state);
  plane_count_switch(settlement, state);
  return true;
}

/*
 * Sets modes from the forces of all at once, once an event resolution. False if there are none, or it was done before.
 */
static bool settle_together(struct Settlement *settlement) {
  if (settlement->has_found_forces) return false;
  settlement->has_found_forces = true;
  return plane_forces_settle(settlement);
}

/*
 * Finds the slip directions of frictions that begin to slide; sets *again if any turns, or sticks because it
 * accelerates along none. Returns NULL, or the reason why the motion cannot go on.
 */
static const char *act_on_headings(struct Settlement *settlement, bool *again) {
  bool heads = false;
  size_t stays = settlement->switches->plane_count;
  for (size_t i = 0; i < settlement->switches->plane_count; i++)
    heads |= plane_state(settlement, i).mode == PLANE_HEADS;
  if (!heads) return NULL;
  if (!plane_headings_find(settlement, again, &stays)) {
    *again = true;
    return settle_together(settlement) ? NULL : refuse_directions(settlement);
  }
  if (stays == settlement->switches->plane_count) return NULL;
  *again = true;
  struct PlaneState state = plane_state(settlement, stays);
  plane_stick(settlement, &state);
  plane_count_switch(settlement, &state);
  return NULL;
}

/* Returns a friction in a plane that has switched more often than that; friction_count for none. */
static size_t find_flipping(const struct Settlement *settlement, double often) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->plane_count; i++)
    if (settlement->flips[friction_indicator(switches, switches->planes[i].along)] > often)
      return switches->planes[i].along;
  return switches->friction_count;
}

/* Lets frictions at rest share the load of one that exceeds its stiction. True if there is such a one. */
static bool share_loads(struct Settlement *settlement) {
  bool shares = false;
  for (size_t i = 0; i < settlement->switches->plane_count && !shares; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool rests = state.has_force && !state.is_given && !(state.speed > state.small);
    shares = rests && is_overcome(settlement, &state) && plane_loads_share(settlement, i);
  }
  return shares;
}

static const char *act_on_planes(struct Settlement *settlement, bool *again) {
  bool stops = false;
  *again = share_loads(settlement);
  if (*again) return NULL;
  for (size_t i = 0; i < settlement->switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    if (state.is_free || !state.has_force) *again |= change_force(settlement, &state);
    else if (state.is_given) *again |= follow_given(settlement, &state);
    else if (is_stopping(settlement, &state)) stops = true;
    else *again |= state.mode == PLANE_STICKS ? leave_rest(settlement, &state) : change_slide(settlement, &state);
  }
  if (*again) return NULL;
  if (stops) {
    *again = true;
    return planes_stop(settlement) || settle_together(settlement) ? NULL : refuse_directions(settlement);
  }
  return act_on_headings(settlement, again);
}

static const char *act(struct Settlement *settlement, bool *again) {
  const char *problem = frictions_act(settlement, again);
  bool goes_round = find_flipping(settlement, TOGETHER_LIMIT) < settlement->switches->friction_count;
  if (problem == NULL && !*again && goes_round && settle_together(settlement)) *again = true;
  else if (problem == NULL && !*again) problem = act_on_planes(settlement, again);
  size_t flipping = find_flipping(settlement, FRICTION_FLIP_LIMIT);
  if (problem == NULL && flipping < settlement->switches->friction_count) return frictions_refuse(settlement, flipping);
  return problem;
}

static void set_plane(struct Settlement *settlement, size_t plane, bool slides) {
  struct PlaneState state = plane_state(settlement, plane);
  const double heading[] = {mode_of(settlement, state.facts->heading[0]), mode_of(settlement, state.facts->heading[1])};
  if (!slides) plane_stick(settlement, &state);
  else if (plane_moves(&state)) plane_slide(settlement, &state);
  else plane_head(settlement, &state, heading);
}

/* Before the start they move freely or slide, with the direction along: there is no slip direction yet. */
static void guess(struct Instance *instance) {
  struct Settlement settlement = settlement_of(instance);
  const struct SwitchTable *switches = settlement.switches;
  struct Point point = instance_point(instance);
  double *parameter = instance->parameter;
  for (size_t i = 0; i < switches->plane_count; i++) {
    const struct PlaneState state = {.facts = &switches->planes[i]};
    plane_free(&settlement, &state);
    parameter[state.facts->heading[0]] = 1.0;
    parameter[state.facts->heading[1]] = 0.0;
  }
  size_t rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  memset(settlement.acceleration, 0, rows * sizeof *settlement.acceleration);
  if (lagrangian.prepare(parameter, instance->prepared) != 0) return;
  switches->switching_values(&point, settlement.acceleration, settlement.value);
  for (size_t i = 0; i < switches->plane_count; i++) {
    size_t along = switches->planes[i].along;
    if (speed_in_plane(&settlement, along) > 0.0) parameter[switches->frictions[along].mode] = PLANE_SLIDES;
  }
}

const struct FrictionLaws plane_friction_laws = {.act = act,
                                                 .tell = frictions_tell,
                                                 .blame = frictions_blame,
                                                 .check = frictions_check,
                                                 .release = frictions_release,
                                                 .resolve_jam = jams_resolve,
                                                 .explain_jam = frictions_explain_jam,
                                                 .guess = guess,
                                                 .set_plane = set_plane,
                                                 .find_impulses = cone_impulses_find,
                                                 .has_other_impulses = cone_impulses_have_others};
