/*
 * Several frictions of one body slow down together and come to rest at the same time, as those of a disk on many points, so that
 * none of them could stick by itself: all that are slow are tried together.
 */
#include "planes/plane_stops.h"

/* All that are slow stick for a try. */
static void try_all(struct Settlement *settlement) {
  for (size_t i = 0; i < settlement->switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool tries = state.mode != PLANE_STICKS && plane_is_slow(settlement, &state);
    settlement->takes_part[settlement->switches->contact_count + state.facts->along] = tries ? 1.0 : 0.0;
    if (tries) plane_stick(settlement, &state);
    if (tries) plane_count_switch(settlement, &state);
  }
}

/* The one of those that are tried which goes furthest beyond its stiction; plane_count for none. */
static size_t find_overcome(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t found = switches->plane_count;
  double most = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool is_tried = settlement->takes_part[switches->contact_count + state.facts->along] != 0.0;
    if (!is_tried || state.mode != PLANE_STICKS || !(state.needed - state.stiction > most)) continue;
    most = state.needed - state.stiction;
    found = i;
  }
  return found;
}

/* It slides on, or begins anew where its velocity is none. */
static void let_plane_slide(struct Settlement *settlement, size_t plane) {
  struct PlaneState state = plane_state(settlement, plane);
  if (plane_moves(&state)) plane_slide(settlement, &state);
  else plane_head(settlement, &state, state.force);
}

/* Brings what sticks to rest, and what begins anew. False where that cannot be. */
static bool bring_to_rest(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool moves = false;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(settlement, i);
    bool begins = state.mode == PLANE_HEADS && !state.is_free && !plane_moves(&state);
    if (begins) plane_stick(settlement, &state);
    moves |= (begins || state.mode == PLANE_STICKS) && state.speed > 0.0;
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
    if (overcome < count) let_plane_slide(settlement, overcome);
  }
  return bring_to_rest(settlement);
}
