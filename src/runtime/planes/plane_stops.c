/*
 * Several frictions of one body slow down together and come to rest at the same time, as those of a disk on many points, so that
 * none of them could stick by itself: all that are slow are tried together.
 */
#include "planes/plane_stops.h"

#include <math.h>

#include "contacts/frictions.h"
#include "planes/plane_loads.h"

/* In settlement->takes_part: it is tried; and found to have no hold of what moves, as a slider at the dead centre of its crank. */
static const double is_tried = 1.0, has_no_hold = 2.0;

/* So many times its stiction no friction is asked for that holds. */
static const double hopeless = 1e6;

/* All that are slow stick for a try. */
static void try_all(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool tries = state.mode != PLANE_STICKS && !state.is_given && plane_is_slow(settlement, &state);
    settlement->takes_part[settlement->switches->contact_count + state.facts->along] = tries ? is_tried : 0.0;
    if (tries) plane_stick(settlement, &state);
    if (tries) plane_count_switch(settlement, &state);
  }
}

/* Whether its velocity goes on though it sticks. */
static bool goes_on(const struct Settlement *settlement, const struct PlaneState *state) {
  double largest = 0.0;
  for (size_t i = 0; i < 2; i++) {
    size_t place = friction_place(settlement->switches, state->facts->along + i, FRICTION_RATE);
    largest = fmax(largest, settlement->largest[place]);
  }
  return hypot(state->rate[0], state->rate[1]) > friction_held_share * largest;
}

/* The one of those that are tried which goes furthest beyond its stiction; plane_count for none. */
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

/* Whether others take what is too much for it. */
static bool shares_load(struct Settlement *settlement, size_t plane) {
  struct PlaneState state = plane_state(settlement, plane);
  return !goes_on(settlement, &state) && plane_loads_share(settlement, plane);
}

/* It slides on, or begins anew where its velocity is none. */
static void let_plane_slide(struct Settlement *settlement, size_t plane) {
  struct PlaneState state = plane_state(settlement, plane);
  bool passes = goes_on(settlement, &state);
  if (passes || state.needed > hopeless * state.stiction)
    settlement->takes_part[settlement->switches->contact_count + state.facts->along] = has_no_hold;
  if (plane_moves(&state)) plane_slide(settlement, &state);
  else plane_head(settlement, &state, passes ? state.rate : state.force);
}

/* Brings what sticks to rest, and what begins anew. False where that cannot be. */
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
