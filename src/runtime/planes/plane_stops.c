/*
 * Brings frictions in planes to rest together, by an active set method. Frictions of one body, such as those of a
 * disk on many points, slow down and stop at the same time. None can stick by itself. All slow ones stick for a
 * trial. While one exceeds its stiction, the one that exceeds it most shares its load or slides again. This ends
 * because sliding frictions are not tried again, and sharing is limited (plane_loads.c). Each round needs an
 * evaluation of the accelerations.
 */
#include "planes/plane_stops.h"

#include <math.h>

#include "contacts/frictions.h"
#include "planes/plane_loads.h"

/*
 * Values of resolution->takes_part for frictions; 0 for those that are not tried. is_tried: it sticks for a trial.
 * has_no_hold: its constraint cannot stop the motion, as that of a slider at the dead centre of its crank.
 */
static const double is_tried = 1.0, has_no_hold = 2.0;

/* A friction that needs more than this multiple of its stiction cannot stop the motion. */
static const double hopeless = 1e6;

/* Lets all slow frictions stick for a trial. */
static void try_all(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool tries = state.mode != PLANE_STICKS && !state.is_given && plane_is_slow(resolution, &state);
    resolution->takes_part[resolution->switches->contact_count + state.metadata->along] = tries ? is_tried : 0.0;
    if (tries) plane_stick(resolution, &state);
    if (tries) plane_count_switch(resolution, &state);
  }
}

/* True if the velocity of the friction changes although it sticks. */
static bool continues(const struct Resolution *resolution, const struct PlaneState *state) {
  double largest = 0.0;
  for (size_t i = 0; i < 2; i++) {
    size_t slot = friction_slot(resolution->switches, state->metadata->along + i, FRICTION_RATE);
    largest = fmax(largest, resolution->largest[slot]);
  }
  return hypot(state->rate[0], state->rate[1]) > sticking_rate_share * largest;
}

/* Returns the tried friction that exceeds its stiction most; plane_count for none. */
static size_t find_overcome(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t found = switches->plane_count;
  double most = 0.0;
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool takes_part = resolution->takes_part[switches->contact_count + state.metadata->along] != 0.0;
    double beyond = continues(resolution, &state) ? INFINITY : state.needed - state.stiction;
    if (!takes_part || state.mode != PLANE_STICKS || !(beyond > most)) continue;
    most = beyond;
    found = i;
  }
  return found;
}

/* True if other frictions take the load beyond its stiction. */
static bool shares_load(struct Resolution *resolution, size_t plane) {
  struct PlaneState state = plane_state(resolution, plane);
  return !continues(resolution, &state) && plane_loads_share(resolution, plane);
}

/* Lets the friction continue to slide, or slip in a new direction from rest. */
static void let_plane_slide(struct Resolution *resolution, size_t plane) {
  struct PlaneState state = plane_state(resolution, plane);
  bool passes = continues(resolution, &state);
  if (passes || state.needed > hopeless * state.stiction)
    resolution->takes_part[resolution->switches->contact_count + state.metadata->along] = has_no_hold;
  if (plane_moves(&state)) plane_slide(resolution, &state);
  else plane_slip(resolution, &state, passes ? state.rate : state.force);
}

/* Projects to 0 the velocities of frictions that stick, or slip from rest. False if that fails. */
static bool bring_to_rest(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool moves = false;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool can_rest = resolution->takes_part[switches->contact_count + state.metadata->along] != has_no_hold;
    bool begins = state.mode == PLANE_SLIPS && !state.is_free && !state.is_given && !plane_moves(&state) && can_rest;
    if (begins) plane_stick(resolution, &state);
    moves |= (begins || (state.mode == PLANE_STICKS && !state.is_given)) && state.speed > 0.0;
  }
  bool is_done = !moves || resolution->occasion == AT_START || resolution_project_velocities(resolution);
  resolution_restore_modes(resolution);
  return is_done;
}

bool planes_stop(struct Resolution *resolution) {
  size_t overcome = 0, count = resolution->switches->plane_count;
  try_all(resolution);
  while (overcome < count) {
    if (!plane_evaluate(resolution)) return false;
    overcome = find_overcome(resolution);
    if (overcome < count && !shares_load(resolution, overcome)) let_plane_slide(resolution, overcome);
  }
  return bring_to_rest(resolution);
}
