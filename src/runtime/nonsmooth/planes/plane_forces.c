/*
 * Forces F of all contacts at rest, and of the frictions in planes at rest on them, at once. With the accelerations
 * a = free + W F they fulfil the conditions of an impact in cone_search.c, for accelerations in place of rates. A
 * contact presses or opens, and a friction sticks or is at its limit against its acceleration. Faster frictions
 * slide along their velocities; their forces are proportional to those of the contacts, and are eliminated from W.
 * The solution sets the modes. This is tried at most once in an event resolution. It is needed where frictions switch
 * one after another endlessly, or where no slip directions or no forces of contacts are found.
 */
#include "nonsmooth/planes/plane_forces.h"

#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/cones/cones.h"

/* Accelerations, also those by forces, are rounding errors below this share of the largest one. */
static const double least_force_share = 1e-9;

/* With the rows of `impulses`: accelerations without these forces, the forces, and the accelerations with them. */
struct PlaneForces {
  struct Resolution *resolution;
  struct ContactImpulses impulses;
  double *rate, *force, *behind;
};

/* True if the friction is at rest or may be brought to rest. A friction on an open contact moves with it. */
static bool is_at_rest(const struct Resolution *resolution, const struct PlaneState *state) {
  if (state->mode == PLANE_STICKS || !plane_moves(state)) return true;
  return state->has_force && plane_is_slow(resolution, state);
}

/* Lets slow frictions stick, and projects the velocities. False if that fails. */
static bool stop_slow(struct Resolution *resolution) {
  bool moves = false;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (!state.has_force || state.is_given || !is_at_rest(resolution, &state)) continue;
    moves |= state.speed > 0.0;
    plane_stick(resolution, &state);
  }
  return !moves || resolution->occasion == AT_START || resolution_project_velocities(resolution);
}

/* Selects contacts at rest, and frictions except those along lines that stick: these remain active constraints. */
static void choose_impulses(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->contact_count; i++)
    resolution->takes_part[i] = contact_is_at_rest(resolution, i) ? 1.0 : 0.0;
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool holds = friction_sticks(resolution, i) && !is_in_plane(switches, i);
    resolution->takes_part[switches->contact_count + i] = holds ? 0.0 : 1.0;
  }
}

/* Computes the Delassus matrix, and the accelerations without the forces; restores the modes. */
static bool find_free(struct PlaneForces *forces) {
  struct Resolution *resolution = forces->resolution;
  const struct SwitchTable *switches = resolution->switches;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->takes_part[i] != 0.0) set_contact(resolution, i, false);
  for (size_t i = 0; i < switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (state.mode == PLANE_STICKS && !state.is_given) plane_free(resolution, &state);
  }
  bool is_done = plane_evaluate(resolution) && contact_impulses_create(resolution, &forces->impulses);
  resolution_restore_modes(resolution);
  return is_done;
}

static bool slides(const struct PlaneForces *forces, size_t row) {
  const struct SwitchTable *switches = forces->resolution->switches;
  size_t plane = plane_of(switches, forces->impulses.member[row]);
  if (plane == switches->plane_count) return true;
  struct PlaneState state = plane_state(forces->resolution, plane);
  return !is_at_rest(forces->resolution, &state);
}

/* Eliminates sliding frictions: adds their forces to the effects of the contacts, and sets their rows to 0. */
static void join_sliding(struct PlaneForces *forces) {
  const struct ContactImpulses *impulses = &forces->impulses;
  size_t n = impulses->count, contacts = impulses->contact_count;
  for (size_t row = contacts; row < n; row++) {
    if (!slides(forces, row)) continue;
    double share = sliding_share(forces->resolution, impulses->member[row]);
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < contacts; j++)
        impulses->delassus[i * n + j] -=
            share * impulses->coefficient[(row - contacts) * contacts + j] * impulses->delassus[i * n + row];
    memset(&impulses->delassus[row * n], 0, n * sizeof(double));
    forces->rate[row] = 0.0;
  }
}

static void fill_rates_of_planes(struct PlaneForces *forces) {
  const struct Resolution *resolution = forces->resolution;
  for (size_t row = 0; row < forces->impulses.count; row++) {
    size_t member = forces->impulses.member[row];
    forces->rate[row] =
        row < forces->impulses.contact_count
            ? contact_value(resolution, member, CONTACT_ACCELERATION)
            : resolution->value[friction_slot(resolution->switches, member, FRICTION_VELOCITY) + FRICTION_RATE];
  }
}

/* Sets the contacts. One that neither presses nor opens keeps its mode: others may share its force. */
static void set_contacts(struct PlaneForces *forces, double none) {
  struct Resolution *resolution = forces->resolution;
  const struct ContactImpulses *impulses = &forces->impulses;
  for (size_t row = 0; row < impulses->contact_count; row++) {
    size_t contact = impulses->member[row];
    bool presses = forces->force[row] * impulses->delassus[row * impulses->count + row] > none;
    bool stays = contact_is_closed(resolution, contact) && forces->behind[row] <= none;
    if (presses) contact_carry(resolution, contact, forces->force[row]);
    else set_contact(resolution, contact, stays);
    resolution->was_opened[contact] = presses || stays ? 0.0 : 1.0;
  }
}

/* Lets a friction stick with the force that was found. */
static void let_carry(struct PlaneForces *forces, size_t row, struct PlaneState *state) {
  const struct ContactImpulses *impulses = &forces->impulses;
  const double load[] = {-forces->force[row], -forces->force[row + 1]};
  state->sliding = cones_limit(&(struct Cones){.impulses = impulses, .impulse = forces->force}, row);
  plane_carry(forces->resolution, state, load);
}

static void set_planes(struct PlaneForces *forces, double none) {
  struct Resolution *resolution = forces->resolution;
  const struct ContactImpulses *impulses = &forces->impulses;
  for (size_t row = impulses->contact_count; row < impulses->count; row++) {
    size_t plane = plane_of(resolution->switches, impulses->member[row]);
    if (plane == resolution->switches->plane_count) continue;
    struct PlaneState state = plane_state(resolution, plane);
    bool is_pressed = false;
    for (size_t i = 0; i < impulses->contact_count; i++)
      is_pressed |= rests_on(resolution->switches, state.metadata->along, impulses->member[i]) &&
                    contact_is_closed(resolution, impulses->member[i]);
    if (!is_pressed) plane_free(resolution, &state);
    else if (slides(forces, row)) plane_slide(resolution, &state);
    else if (hypot(forces->behind[row], forces->behind[row + 1]) > none)
      plane_slip(resolution, &state, &forces->behind[row]);
    else let_carry(forces, row, &state);
    row++; /* the friction across has the same mode */
  }
}

static bool find_plane_forces(struct PlaneForces *forces) {
  struct Resolution *resolution = forces->resolution;
  size_t n = forces->impulses.count;
  double *block = scratch_take(resolution->instance, SCRATCH_FORCES, 3 * n * sizeof *block);
  if (block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  forces->rate = block;
  forces->force = block + n;
  forces->behind = block + 2 * n;
  fill_rates_of_planes(forces);
  join_sliding(forces);
  double error;
  bool is_done = cone_forces_find(resolution, &forces->impulses, forces->rate, forces->force, &error);
  if (is_done) {
    double largest = fill_rates_behind(&forces->impulses, forces->rate, forces->force, forces->behind);
    double none = fmax(least_force_share * largest, error);
    set_contacts(forces, none);
    set_planes(forces, none);
  }
  scratch_return(resolution->instance, SCRATCH_FORCES);
  return is_done;
}

bool plane_forces_resolve(struct Resolution *resolution) {
  struct PlaneForces forces = {.resolution = resolution};
  if (resolution->has_found_forces) return false;
  resolution->has_found_forces = true;
  if (!stop_slow(resolution)) return false;
  choose_impulses(resolution);
  if (!find_free(&forces)) return false;
  bool is_done = find_plane_forces(&forces);
  contact_impulses_free(resolution, &forces.impulses);
  return is_done;
}
