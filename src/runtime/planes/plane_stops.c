/*
 * Brings frictions in planes to rest together, by an active set method. Frictions of one body, such as those of a disk
 * on many points, slow down and stop at the same time, so that none can stick by itself. All slow ones stick for a
 * trial. While one exceeds its stiction, the one that exceeds it most shares its load or slides again. This ends
 * because sliding frictions are not tried again, and sharing is limited (plane_loads.c). Each round needs an evaluation
 * of the accelerations.
 */
#include "planes/plane_stops.h"

#include <math.h>

#include "contacts/frictions.h"
#include "planes/plane_loads.h"

/*
 * Values of settlement->takes_part for frictions; 0 for those that are not tried. is_tried: it sticks for a trial.
 * has_no_hold: its constraint cannot stop the motion, as that of a slider at the dead centre of its crank.
 */
static const double is_tried = 1.0, has_no_hold = 2.0;

/* In units of its stiction: a friction that needs more cannot stop the motion. */
static const double hopeless = 1e6;

/* Lets all slow frictions stick for a trial. */
static void try_all(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool tries = state.mode != PLANE_STICKS && !state.is_given && plane_is_slow(settlement, &state);
    settlement->takes_part[settlement->switches->contact_count + state.facts->along] = tries ? is_tried : 0.0;
    if (tries) plane_stick(settlement, &state);
    if (tries) plane_count_switch(settlement, &state);
  }
}

/* True if its velocity changes although it sticks. */
static bool goes_on(const struct Settlement *settlement, const struct PlaneState *state) {
  double largest = 0.0;
  for (size_t i = 0; i < 2; i++) {
    size_t place = friction_place(settlement->switches, state->facts->along + i, FRICTION_RATE);
    largest = fmax(largest, settlement->largest[place]);
  }
  return hypot(state->rate[0], state->rate[1]) > friction_held_share * largest;
}

/* Returns the tried friction that exceeds its stiction most; plane_count for none. */
static size_t find_overcome(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t found = switches->plane_count;
  double most = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool takes_part = settlement->takes_part[switches->contact_count + state.facts->along] != 0.0;
    double beyond = goes_on(settlement, &state) ? INFINITY : state.needed - state.stiction;
    if (!takes_part || state.mode != PLANE_STICKS || !(beyond > most)) continue;
    most = beyond;
    found = i;
  }
  return found;
}

/* True if others take what exceeds its stiction. */
static bool shares_load(struct Settlement *settlement, size_t plane) {
  struct PlaneState state = plane_state(settlement, plane);
  return !goes_on(settlement, &state) && plane_loads_share(settlement, plane);
}

/* Lets it slide on, or slip in a new direction from rest. */
static void let_plane_slide(struct Settlement *settlement, size_t plane) {
  struct PlaneState state = plane_state(settlement, plane);
  bool passes = goes_on(settlement, &state);
  if (passes || state.needed > hopeless * state.stiction)
    settlement->takes_part[settlement->switches->contact_count + state.facts->along] = has_no_hold;
  if (plane_moves(&state)) plane_slide(settlement, &state);
  else plane_head(settlement, &state, passes ? state.rate : state.force);
}

/* Projects the velocities of what sticks, or slips from rest, to 0. False if that fails. */
static bool bring_to_rest(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool moves = false;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool can_rest = settlement->takes_part[switches->contact_count + state.facts->along] != has_no_hold;
    bool begins = state.mode == PLANE_HEADS && !state.is_free && !state.is_given && !plane_moves(&state) && can_rest;
    if (begins) plane_stick(settlement, &state);
    moves |= (begins || (state.mode == PLANE_STICKS && !state.is_given)) && state.speed > 0.0;
  }
  bool is_done = !moves || settlement->occasion == AT_START || settlement_push(settlement);
  settlement_restore_modes(settlement);
  return is_done;
}

bool planes_stop(struct Settlement *settlement) {
  size_t overcome = 0, count = settlement->switches->plane_count;
  try_all(settlement);
  while (overcome < count) {
    if (!plane_evaluate(settlement)) return false;
    overcome = find_overcome(settlement);
    if (overcome < count && !shares_load(settlement, overcome)) let_plane_slide(settlement, overcome);
  }
  return bring_to_rest(settlement);
}
