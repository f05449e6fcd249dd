/*
 * Frictions at rest. Those that are slow, and those that stick, are tried to stick. One may need more than its
 * stiction. Then the forces of all, and of the closed contacts at rest, are found together (rest_forces.c), and set the
 * modes. If none are found, open contacts take part too, at most once in an event resolution. A third search starts
 * from the forces of a short step.
 *
 * If the supports are statically indeterminate, the constraints of sticking frictions have the forces of least norm.
 * If these exceed a limit, frictions stick with the forces that were found, which have a margin to their limits.
 */
#include "nonsmooth/planes/plane_rests.h"

#include <math.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/frictions/frictions.h"
#include "nonsmooth/planes/carried_forces.h"
#include "nonsmooth/planes/lines_at_rest.h"
#include "nonsmooth/planes/plane_stops.h"
#include "nonsmooth/planes/rest_forces.h"

/* In units of its stiction: a friction that needs more cannot stop the motion. */
static const double hopeless = 1e6;

/* Relative to the largest stiction: frictions with a smaller one are weak. */
static const double weak_share = 0.01;

bool plane_is_stopping(const struct Resolution *resolution, const struct PlaneState *state) {
  bool has_slowed = state->has_slowed && state->is_first;
  if (state->mode == PLANE_STICKS || !plane_is_slow(resolution, state)) return false;
  if (resolution->occasion == AT_START && state->is_first) return true;
  if (plane_slides(state)) return state->speed <= state->lower || has_slowed || state->has_reversed;
  return plane_has_direction(state) && (state->ahead <= -state->lower || has_slowed);
}

/* True if an event was found where a sticking friction reaches its stiction. */
static bool is_reached(const struct Resolution *resolution, const struct PlaneState *state) {
  return state->mode == PLANE_STICKS && state->has_slowed && state->is_first && !resolution->jumped;
}

bool plane_is_overcome(const struct Resolution *resolution, const struct PlaneState *state) {
  if (state->mode != PLANE_STICKS || state->speed > state->small) return false;
  if (is_reached(resolution, state)) return true;
  /* Importers stop where it exceeds the stiction, however little. One that was located there has no margin left. */
  bool has_no_margin = state->has_slowed && !resolution->jumped;
  double rounding = resolution->occasion == IN_EXCHANGE ? 0.0 : share_at_limit * largest_stiction(resolution);
  return state->needed > state->stiction + (has_no_margin ? -rounding : rounding);
}

static bool any_stops(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    any |= plane_is_stopping(resolution, &state);
  }
  return any;
}

/* True if the friction rests on a contact that takes part. */
static bool rests_on_chosen(const struct Resolution *resolution, const struct PlaneState *state) {
  bool rests = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    rests |= resolution->part[i] != LEFT_OUT && rests_on(resolution->switches, state->metadata->along, i);
  return rests;
}

/*
 * Selects the frictions at rest, by enum Part, and the contacts at rest if they may open and close. If one friction
 * stops, all slow ones may. Frictions of one body, such as those of a disk on many points, slow down and stop at the
 * same time.
 */
static void choose_at_rest(struct Resolution *resolution, bool with_contacts) {
  bool may_stop = with_contacts || any_stops(resolution);
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    resolution->part[i] = !with_contacts || !contact_may_rest(resolution, i) ? LEFT_OUT
                          : contact_is_closed(resolution, i)                 ? TAKES_PART
                                                                             : WAS_OPEN;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool stops = may_stop && state.mode != PLANE_STICKS && plane_is_slow(resolution, &state),
         begins = plane_has_direction(&state) && !plane_moves(&state),
         sticks = state.mode == PLANE_STICKS && (with_contacts || state.speed <= state.small),
         has_force = state.mode != PLANE_IS_FREE && state.has_force;
    bool rests =
        has_force ? stops || begins || sticks : (stops || !plane_moves(&state)) && rests_on_chosen(resolution, &state);
    bool is_overcome = (begins && !stops && state.mode == PLANE_IMPENDS) || plane_is_overcome(resolution, &state);
    *part_of_plane(resolution, &state) = state.is_given || !rests ? LEFT_OUT
                                         : stops                  ? IS_SLOW
                                         : is_overcome            ? IS_OVERCOME
                                                                  : TAKES_PART;
  }
  lines_choose(resolution);
}

/* Lets a friction slide on whose constraint cannot stop the motion. */
static void let_pass(struct Resolution *resolution, const struct PlaneState *state, const double *direction) {
  *part_of_plane(resolution, state) = LEFT_OUT;
  if (plane_moves(state)) plane_slide(resolution, state);
  else plane_slip(resolution, state, direction);
}

/* Lets slow frictions slide on. */
static void release_slow(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) != IS_SLOW) continue;
    let_pass(resolution, &state, state.velocity);
    plane_count_switch(resolution, &state);
  }
}

/* Lets all frictions at rest stick. False if accelerations do not exist. */
static bool try_to_stick(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == LEFT_OUT) continue;
    plane_stick(resolution, &state);
    plane_count_switch(resolution, &state);
  }
  lines_stick(resolution);
  return plane_evaluate(resolution);
}

/*
 * Projects out the velocities of contacts and frictions at rest, except those that slide, if the motion stops. False if
 * that fails.
 */
static bool bring_to_rest(struct Resolution *resolution, bool stops) {
  bool moves = false;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < resolution->switches->contact_count && stops; i++)
    if (resolution->part[i] != LEFT_OUT) set_contact(resolution, i, true);
  for (size_t i = 0; i < resolution->switches->plane_count && stops; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == LEFT_OUT || plane_slides(&state)) continue;
    plane_stick(resolution, &state);
    moves |= state.speed > 0.0;
  }
  bool is_projected = moves && resolution->occasion != AT_START;
  bool is_done = !is_projected || resolution_project_velocities(resolution);
  resolution_restore_modes(resolution);
  return is_done && (!is_projected || let_stopped_slip(resolution));
}

/* True if the rate of the velocity is above `least`, and no small share of the largest one in the event. */
static bool has_rate(const struct Resolution *resolution, const struct PlaneState *state, double least) {
  for (size_t i = 0; i < 2; i++) {
    size_t slot = friction_slot(resolution->switches, state->metadata->along + i, FRICTION_RATE);
    least = fmax(least, sticking_rate_share * resolution->largest[slot]);
  }
  return hypot(state->rate[0], state->rate[1]) > least;
}

bool plane_is_unheld(const struct Resolution *resolution, const struct PlaneState *state) {
  size_t slot = friction_slot(resolution->switches, state->metadata->along, FRICTION_RATE);
  double bound = fmax(resolution->error_bound[slot], resolution->error_bound[slot + FRICTION_VALUES]);
  bound = fmax(bound, resolution->least_acceleration);
  return state->mode == PLANE_STICKS && has_rate(resolution, state, bound) &&
         has_rate(resolution, state, resolution->tolerances.acceleration);
}

bool plane_is_lost(const struct Resolution *resolution, const struct PlaneState *state) {
  const struct FrictionMetadata *frictions = &resolution->switches->frictions[state->metadata->along];
  const double *forces = resolution_accelerations(resolution) + lagrangian.coordinate_count;
  double force = hypot(forces[frictions[0].constraint], forces[frictions[1].constraint]);
  return state->mode == PLANE_STICKS && force > hopeless * largest_stiction(resolution);
}

/* True if the velocity of a friction that slid changes although it sticks. */
static bool continues(const struct Resolution *resolution, const struct PlaneState *state) {
  return *part_of_plane(resolution, state) == IS_SLOW && has_rate(resolution, state, 0.0);
}

/* True if no friction that sticks needs more than its stiction. */
static bool all_stick(const struct Resolution *resolution) {
  bool all = true;
  double rounding = share_at_limit * largest_stiction(resolution);
  for (size_t i = 0; i < resolution->switches->plane_count && all; i++) {
    struct PlaneState state = plane_state(resolution, i);
    enum Part part = *part_of_plane(resolution, &state);
    if (part == LEFT_OUT || state.mode != PLANE_STICKS) continue;
    double limit = state.stiction + (part == IS_OVERCOME ? -rounding : rounding);
    all = state.needed <= limit && !continues(resolution, &state) && !plane_is_unheld(resolution, &state);
  }
  return all && !lines_exceed(resolution, rounding);
}

/* Sets the contacts that take part. One that neither presses nor opens keeps its mode: others may share its force. */
static void take_contacts(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  for (size_t row = 0; row < forces->impulses.contact_count; row++) {
    size_t contact = forces->impulses.member[row];
    bool presses = forces->force[row] * forces->impulses.delassus[row * (forces->n + 1)] > forces->none;
    bool stays = resolution->part[contact] == TAKES_PART && forces->behind[row] <= forces->none;
    if (presses) contact_carry(resolution, contact, forces->force[row]);
    else set_contact(resolution, contact, stays);
    resolution->forced[contact] = presses ? FORCED_CLOSED : stays ? UNFORCED : FORCED_OPEN;
  }
}

/*
 * Lets frictions in planes slip against their forces: at the onset their accelerations are small and have no direction.
 * The others stick by their constraints alone.
 */
static void take_planes(struct RestForces *forces) {
  for (size_t row = forces->impulses.contact_count; row < forces->lines; row += 2) {
    const double *force = &forces->force[row], against[] = {-force[0], -force[1]};
    struct PlaneState state = state_of_row(forces, row);
    bool has_force = hypot(force[0], force[1]) > 0.0;
    if (!rest_slips(forces, row)) plane_stick(forces->resolution, &state);
    else plane_slip(forces->resolution, &state, has_force ? against : &forces->behind[row]);
  }
}

/* Keeps the force of a friction that sticks, without its constraint. */
static void release_row(const struct RestForces *forces, size_t row) {
  if (row_is_of_line(forces, row)) {
    line_keep(forces->resolution, forces->impulses.member[row]);
    return;
  }
  struct PlaneState state = state_of_row(forces, row);
  plane_carry(forces->resolution, &state, state.force);
  plane_release(forces->resolution, &state);
}

/*
 * Weak frictions are those whose contacts are about to open. They keep their forces without constraints if others
 * constrain their velocities. Their constraints would take too much of a changing load again and again. False if that
 * cannot be determined.
 */
static bool release_weak(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  double most = largest_stiction(resolution);
  bool is_determined = true, is_constrained = false;
  for (size_t row = forces->impulses.contact_count; row < forces->n && is_determined;
       row += rows_of_friction(forces, row)) {
    size_t friction = forces->impulses.member[row];
    const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
    bool is_weak = value[FRICTION_FORCE] > 0.0 && value[FRICTION_STICTION] < weak_share * most;
    if (!is_weak || rest_slips(forces, row) || !friction_sticks(resolution, friction)) continue;
    is_determined = frictions_find_constrained(resolution, friction, &is_constrained);
    if (is_constrained) release_row(forces, row);
  }
  return is_determined;
}

/* Lets frictions in planes slip that still are overcome, as within rounding of the load that all hold together. */
static bool let_overcome_slip(struct RestForces *forces) {
  bool any = false;
  for (size_t row = forces->impulses.contact_count; row < forces->lines; row += 2) {
    struct PlaneState state = state_of_row(forces, row);
    if (state.mode != PLANE_STICKS || !(state.needed > state.stiction) ||
        !plane_is_overcome(forces->resolution, &state))
      continue;
    plane_slip(forces->resolution, &state, state.force);
    any = true;
  }
  return !any || plane_evaluate(forces->resolution);
}

/* Sets the modes by the solution. False if accelerations do not exist. */
static bool take_rests(struct RestForces *forces) {
  take_contacts(forces);
  take_planes(forces);
  lines_take(forces);
  if (!plane_evaluate(forces->resolution)) return false;
  bool has_contacts = forces->impulses.contact_count > 0;
  if (!has_contacts && all_stick(forces->resolution)) return true;
  return carried_forces_take(forces) && lines_let_overcome_slip(forces) && let_overcome_slip(forces) &&
         release_weak(forces);
}

/* Lets frictions without kinetic friction slip if they need more than their stiction. */
static void release_others(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool rests = *part_of_plane(resolution, &state) != LEFT_OUT;
    if (rests && !rest_is_unknown(resolution, state.metadata->along) && state.needed > state.stiction)
      plane_slip(resolution, &state, state.force);
  }
}

/*
 * Lets frictions slide whose constraint cannot stop the motion, as that of a slider at the dead centre of its crank.
 * They accelerate although they stick, or would need an enormous force.
 */
static void release_passing(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    enum Part *part = part_of_plane(resolution, &state);
    bool passes = continues(resolution, &state);
    bool is_hopeless = *part == IS_SLOW && state.needed > hopeless * state.stiction;
    if (*part != LEFT_OUT && (passes || is_hopeless)) let_pass(resolution, &state, passes ? state.rate : state.force);
  }
}

/* Lets slow frictions slide on that do not stick by the solution: their directions are known. True if there are any. */
static bool let_slow_slide(struct RestForces *forces) {
  bool any = false;
  for (size_t row = forces->impulses.contact_count; row < forces->lines; row += 2) {
    struct PlaneState state = state_of_row(forces, row);
    enum Part *part = part_of_plane(forces->resolution, &state);
    if (!rest_slips(forces, row) || *part != IS_SLOW || !plane_moves(&state)) continue;
    *part = LEFT_OUT;
    plane_slide(forces->resolution, &state);
    any = true;
  }
  return any;
}

/*
 * Selects the frictions again, and lets slow ones slip along the directions of the forces. Along their small velocities
 * there are no forces; these change the direction of the motion at once.
 */
static void choose_without_slow(struct Resolution *resolution) {
  choose_at_rest(resolution, true);
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    enum Part *part = part_of_plane(resolution, &state);
    if (*part == IS_SLOW) *part = TAKES_PART;
  }
}

/* Finds the modes where not all can stick. False if that fails. */
static bool find_slips(struct Resolution *resolution, bool continues) {
  struct RestForces forces = {.resolution = resolution, .continues = continues};
  release_others(resolution);
  for (bool is_found = false, any_slides = false; !is_found;) {
    if (!rest_forces_find(&forces)) {
      if (!any_slides) return false;
      choose_without_slow(resolution);
      any_slides = false;
      continue;
    }
    is_found = forces.n == 0 || !let_slow_slide(&forces);
    any_slides |= !is_found;
    if (!is_found) rest_forces_free(&forces);
  }
  bool is_done = forces.n == 0 || take_rests(&forces);
  rest_forces_free(&forces);
  return is_done;
}

/* Returns whether the modes were found; else restores those that were kept. */
static bool found_or_restored(struct Resolution *resolution, bool is_found) {
  if (is_found) return true;
  resolution_restore_modes(resolution);
  resolution_evaluate(resolution); /* the caller sees missing accelerations in the next evaluation */
  return false;
}

/* Lets closed contacts take part: their forces are unknown too. */
static void take_closed(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    resolution->part[i] = contact_is_closed(resolution, i) ? TAKES_PART : LEFT_OUT;
}

static bool find_rests(struct Resolution *resolution) {
  bool stops;
  choose_at_rest(resolution, false);
  if (!plane_stops_motion(resolution, &stops)) return false;
  if (!stops) release_slow(resolution);
  if (!try_to_stick(resolution)) return false;
  if (all_stick(resolution)) return bring_to_rest(resolution, stops);
  release_passing(resolution);
  take_closed(resolution);
  return find_slips(resolution, false) && bring_to_rest(resolution, stops);
}

bool plane_rests_find(struct Resolution *resolution) {
  resolution_keep_modes(resolution);
  return found_or_restored(resolution, find_rests(resolution));
}

/* Lets frictions slide again on open contacts that take part: they have a force where these press. */
static void slide_on_chosen(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool is_free = state.mode == PLANE_IS_FREE && !state.is_given && plane_moves(&state);
    if (is_free && rests_on_chosen(resolution, &state)) plane_slide(resolution, &state);
  }
}

/* Lets slow frictions slide on, where they have a velocity. */
static void let_moving_pass(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    enum Part *part = part_of_plane(resolution, &state);
    if (*part == IS_SLOW && plane_moves(&state)) let_pass(resolution, &state, state.velocity);
  }
}

/*
 * Finds the modes with the contacts at rest. A continuation from the forces of a short step knows whether the motion
 * stops; else slow frictions slide on.
 */
static bool find_with_contacts(struct Resolution *resolution, bool continues, bool stops) {
  resolution_keep_modes(resolution);
  choose_at_rest(resolution, true);
  if (continues && !stops) let_moving_pass(resolution);
  slide_on_chosen(resolution);
  bool is_found = (continues || plane_stops_motion(resolution, &stops)) && find_slips(resolution, continues) &&
                  bring_to_rest(resolution, stops);
  return found_or_restored(resolution, is_found);
}

bool plane_rests_find_with_contacts(struct Resolution *resolution) {
  if (resolution->has_found_forces) return false;
  resolution->has_found_forces = true;
  return find_with_contacts(resolution, false, false);
}

bool plane_rests_continue(struct Resolution *resolution, bool stops) {
  return find_with_contacts(resolution, true, stops);
}
