/*
 * Frictions in planes at rest. Those that are slow, and those that stick, are tried to stick. If one would need more
 * than its stiction, the forces T of all are found together. They and the accelerations a fulfil the law of
 * cone_search.c:
 *
 *   |T| <= limit,  and  a = 0 or T = -limit a / |a|.
 *
 * With the contacts that are closed, a and the forces of the contacts, and so the limits, are linear functions of T.
 * They are read from the equations of motion: without T, and with one T after another.
 *
 * If the supports are statically indeterminate, the constraints of sticking frictions have the forces of least norm.
 * If these exceed a limit, frictions stick with the forces T that were found, which have a margin to their limits.
 */
#include "nonsmooth/planes/plane_rests.h"

#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/frictions.h"
#include "evaluation/services.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/cones/cones.h"

/* Relative to the largest acceleration: smaller ones are rounding errors. */
static const double rounded_share = 1e-9;

/*
 * Relative to the limit. Forces that exceed it by less than share_at_limit are at the limit. A friction that was
 * overcome slips within least_margin of it: a smaller margin is lost in rounding where frictions share a load.
 */
static const double share_at_limit = 1e-9, least_margin = 1e-7;

/* In units of the kinetic friction: a force with which the linear functions are read. Larger ones may jam contacts. */
static const double trial_direction = 0.1;

/* In units of its stiction: a friction that needs more cannot stop the motion. */
static const double hopeless = 1e6;

/* Relative to the largest stiction: frictions with a smaller one are weak. */
static const double weak_share = 0.01;

/*
 * Values of resolution->takes_part for a friction at rest. IS_OVERCOME: at its limit it slips. IS_SLOW: it slid, and
 * continues with its velocity if it does not stick.
 */
enum { IS_AT_REST = 1, IS_OVERCOME = 2, IS_SLOW = 3 };

/* The frictions whose forces are unknown, with two rows each. */
struct PlaneRests {
  struct Resolution *resolution;
  struct ContactImpulses impulses; /* derivatives of a, limits without T and their derivatives; kinetic ones if slips */
  size_t n;                        /* number of rows */
  double *free;                    /* a without T */
  double *force, *behind;          /* T, and a with it */
  double *stiction, *given_stiction; /* derivatives of the stiction, and stiction without T */
  double *kinetic, *given_kinetic;   /* the same for the kinetic friction */
  double *slips;                     /* 1 if the friction slips: its limit is the kinetic friction */
  double none;                       /* accelerations that count as 0 */
};

static double *part_of_plane(const struct Resolution *resolution, const struct PlaneState *state) {
  return &resolution->takes_part[resolution->switches->contact_count + state->metadata->along];
}

bool plane_is_stopping(const struct Resolution *resolution, const struct PlaneState *state) {
  bool has_slowed = state->has_slowed && state->is_first;
  if (state->mode == PLANE_STICKS || !plane_is_slow(resolution, state)) return false;
  if (resolution->occasion == AT_START && state->is_first) return true;
  if (plane_slides(state)) return state->speed <= state->lower || has_slowed || state->has_reversed;
  return plane_has_direction(state) && (state->ahead <= -state->lower || has_slowed);
}

static double largest_stiction(const struct Resolution *resolution) {
  double largest = 0.0;
  for (size_t i = 0; i < resolution->switches->plane_count; i++)
    largest = fmax(largest, plane_state(resolution, i).stiction);
  return largest;
}

/* True if an event was found where a sticking friction reaches its stiction. */
static bool is_reached(const struct Resolution *resolution, const struct PlaneState *state) {
  return state->mode == PLANE_STICKS && state->has_slowed && state->is_first && !resolution->jumped;
}

bool plane_is_overcome(const struct Resolution *resolution, const struct PlaneState *state) {
  if (state->mode != PLANE_STICKS || state->speed > state->small) return false;
  if (is_reached(resolution, state)) return true;
  if (!(state->needed > state->stiction)) return false;
  /* Importers stop where it exceeds the stiction, however little. */
  return resolution->occasion == IN_EXCHANGE ||
         state->needed > state->stiction + share_at_limit * largest_stiction(resolution);
}

static bool any_stops(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    any |= plane_is_stopping(resolution, &state);
  }
  return any;
}

/*
 * Selects the frictions at rest, in takes_part. If one stops, all slow ones may. Frictions of one body, such as those
 * of a disk on many points, slow down and stop at the same time.
 */
static void choose_at_rest(struct Resolution *resolution) {
  bool may_stop = any_stops(resolution);
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool stops = may_stop && state.mode != PLANE_STICKS && plane_is_slow(resolution, &state),
         begins = plane_has_direction(&state) && !plane_moves(&state);
    bool rests = !state.is_given && state.mode != PLANE_IS_FREE && state.has_force &&
                 (stops || begins || (state.mode == PLANE_STICKS && state.speed <= state.small));
    bool is_overcome = (begins && !stops && state.mode == PLANE_IMPENDS) || plane_is_overcome(resolution, &state);
    *part_of_plane(resolution, &state) = !rests ? 0.0 : stops ? IS_SLOW : is_overcome ? IS_OVERCOME : IS_AT_REST;
  }
}

/* Lets all frictions at rest stick. False if accelerations do not exist. */
static bool try_to_stick(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == 0.0) continue;
    plane_stick(resolution, &state);
    plane_count_switch(resolution, &state);
  }
  return plane_evaluate(resolution);
}

/* Projects out the velocities of frictions at rest, except those that slide. False if that fails. */
static bool bring_to_rest(struct Resolution *resolution) {
  bool moves = false;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == 0.0 || plane_slides(&state)) continue;
    plane_stick(resolution, &state);
    moves |= state.speed > 0.0;
  }
  bool is_projected = moves && resolution->occasion != AT_START;
  bool is_done = !is_projected || resolution_project_velocities(resolution);
  resolution_restore_modes(resolution);
  return is_done && (!is_projected || let_stopped_slip(resolution));
}

/* True if the velocity of a friction that slid changes although it sticks. */
static bool continues(const struct Resolution *resolution, const struct PlaneState *state) {
  double largest = 0.0;
  for (size_t i = 0; i < 2; i++) {
    size_t slot = friction_slot(resolution->switches, state->metadata->along + i, FRICTION_RATE);
    largest = fmax(largest, resolution->largest[slot]);
  }
  bool is_slow = *part_of_plane(resolution, state) == IS_SLOW;
  return is_slow && hypot(state->rate[0], state->rate[1]) > sticking_rate_share * largest;
}

/* True if no friction that sticks needs more than its stiction. */
static bool all_stick(const struct Resolution *resolution) {
  bool all = true;
  double rounding = share_at_limit * largest_stiction(resolution);
  for (size_t i = 0; i < resolution->switches->plane_count && all; i++) {
    struct PlaneState state = plane_state(resolution, i);
    double part = *part_of_plane(resolution, &state);
    if (part == 0.0 || state.mode != PLANE_STICKS) continue;
    double limit = state.stiction + (part == IS_OVERCOME ? -rounding : rounding);
    all = state.needed <= limit && !continues(resolution, &state);
  }
  return all;
}

/* True if the force of a friction at rest is unknown: it has kinetic friction, in units of which it is found. */
static bool has_unknown_force(const struct Resolution *resolution, const struct PlaneState *state) {
  return *part_of_plane(resolution, state) != 0.0 && state->sliding > 0.0;
}

static struct PlaneState state_of_row(const struct PlaneRests *rests, size_t row) {
  const struct Resolution *resolution = rests->resolution;
  return plane_state(resolution, plane_of(resolution->switches, rests->impulses.member[row]));
}

/* Takes the workspace. False without memory. */
static bool create_rests(struct Resolution *resolution, struct PlaneRests *rests) {
  size_t count = resolution->switches->plane_count, n = 0;
  for (size_t i = 0; i < count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    n += has_unknown_force(resolution, &state) ? 2 : 0;
  }
  *rests = (struct PlaneRests){.resolution = resolution, .n = n};
  size_t numbers = 4 * n * n + 7 * n;
  double *block =
      scratch_take(resolution->instance, SCRATCH_RESTS, numbers * sizeof *block + n * sizeof *rests->impulses.member);
  if (block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  rests->impulses = (struct ContactImpulses){
      .friction_count = n, .count = n, .deciding_count = n, .delassus = block, .coefficient = block + n * n};
  rests->stiction = rests->impulses.coefficient + n * n;
  rests->kinetic = rests->stiction + n * n;
  rests->free = rests->kinetic + n * n;
  rests->force = rests->free + n;
  rests->behind = rests->force + n;
  rests->given_stiction = rests->behind + n;
  rests->given_kinetic = rests->given_stiction + n;
  rests->slips = rests->given_kinetic + n;
  rests->impulses.given = rests->slips + n;
  rests->impulses.member = (size_t *)(rests->impulses.given + n);
  for (size_t i = 0, row = 0; i < count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (!has_unknown_force(resolution, &state)) continue;
    for (size_t side = 0; side < 2; side++) rests->impulses.member[row++] = state.metadata->along + side;
  }
  return true;
}

/* Sets the direction in units of the kinetic friction in which the friction of a row has a force. */
static void set_direction(const struct PlaneRests *rests, size_t row, double direction) {
  struct PlaneState state = state_of_row(rests, row);
  resolution_set_mode(rests->resolution, state.metadata->slip_direction[row % 2], direction);
}

/* Fills the derivatives by the force of one row. False if accelerations do not exist. */
static bool fill_column(struct PlaneRests *rests, size_t column) {
  size_t n = rests->n;
  set_direction(rests, column, trial_direction);
  bool exist = plane_evaluate(rests->resolution);
  double force = exist ? -trial_direction * state_of_row(rests, column).sliding : 0.0;
  for (size_t first = 0; first < n && force != 0.0; first += 2) {
    struct PlaneState state = state_of_row(rests, first);
    for (size_t row = first; row < first + 2; row++) {
      rests->impulses.delassus[row * n + column] = (state.rate[row - first] - rests->free[row]) / force;
      rests->stiction[row * n + column] = (state.stiction - rests->given_stiction[row]) / force;
      rests->kinetic[row * n + column] = (state.sliding - rests->given_kinetic[row]) / force;
    }
  }
  set_direction(rests, column, 0.0);
  return exist;
}

/* Reads the linear functions. False if accelerations do not exist. */
static bool fill_functions(struct PlaneRests *rests) {
  for (size_t row = 0; row < rests->n; row++) {
    struct PlaneState state = state_of_row(rests, row);
    plane_release(rests->resolution, &state);
    set_direction(rests, row, 0.0);
  }
  bool exist = plane_evaluate(rests->resolution);
  for (size_t row = 0; row < rests->n; row++) {
    struct PlaneState state = state_of_row(rests, row);
    rests->free[row] = state.rate[row % 2];
    rests->given_stiction[row] = state.stiction;
    rests->given_kinetic[row] = state.sliding;
  }
  for (size_t column = 0; column < rests->n && exist; column++) exist = fill_column(rests, column);
  return exist;
}

static bool slips(const struct PlaneRests *rests, size_t row) {
  return rests->slips[row] != 0.0;
}

static void fill_limits(struct PlaneRests *rests) {
  size_t n = rests->n;
  for (size_t row = 0; row < n; row++) {
    bool is_kinetic = slips(rests, row);
    rests->impulses.given[row] = (is_kinetic ? rests->given_kinetic : rests->given_stiction)[row];
    memcpy(rests->impulses.coefficient + row * n, (is_kinetic ? rests->kinetic : rests->stiction) + row * n,
           n * sizeof(double));
  }
}

/* Returns a limit with the forces, given it without them and its derivatives. */
static double limit_at(const struct PlaneRests *rests, size_t row, const double *given, const double *derivative) {
  double limit = given[row];
  for (size_t j = 0; j < rests->n; j++) limit += derivative[row * rests->n + j] * rests->force[j];
  return limit;
}

/* True if a friction accelerates by the solution. */
static bool accelerates(const struct PlaneRests *rests, size_t row) {
  return hypot(rests->behind[row], rests->behind[row + 1]) > rests->none;
}

/* True if a friction accelerates by the solution, or was overcome and is at its limit. */
static bool begins_to_slip(const struct PlaneRests *rests, size_t row) {
  const double *force = &rests->force[row];
  struct PlaneState state = state_of_row(rests, row);
  double limit = limit_at(rests, row, rests->impulses.given, rests->impulses.coefficient);
  double rounding = share_at_limit * largest_stiction(rests->resolution),
         response = rests->impulses.delassus[row * (rests->n + 1)];
  double least = (1.0 - least_margin) * limit - rounding - (response > 0.0 ? rests->none / response : 0.0);
  bool is_overcome = *part_of_plane(rests->resolution, &state) == IS_OVERCOME;
  return accelerates(rests, row) || (is_overcome && hypot(force[0], force[1]) >= least);
}

/* Marks the frictions that slip, which have their kinetic limit. True if a limit falls. */
static bool lower_limits(struct PlaneRests *rests) {
  bool falls = false;
  for (size_t row = 0; row < rests->n; row += 2) {
    if (slips(rests, row) || !begins_to_slip(rests, row)) continue;
    falls |= limit_at(rests, row, rests->given_stiction, rests->stiction) >
             (1.0 + share_at_limit) * limit_at(rests, row, rests->given_kinetic, rests->kinetic);
    rests->slips[row] = rests->slips[row + 1] = 1.0;
  }
  return falls;
}

/* Finds the forces. False if there are none. */
static bool solve_law(struct PlaneRests *rests) {
  double error;
  if (!fill_functions(rests)) return false;
  do {
    fill_limits(rests);
    if (!cone_forces_find(rests->resolution, &rests->impulses, rests->free, rests->force, &error)) return false;
    double largest = fill_rates_behind(&rests->impulses, rests->free, rests->force, rests->behind);
    rests->none = fmax(rounded_share * largest, error);
    rests->resolution->least_acceleration = rests->none;
  } while (lower_limits(rests));
  return true;
}

/* Lets a friction slip against its force: at the onset its acceleration is small and has no direction. */
static void let_slip(struct PlaneRests *rests, size_t row) {
  const double *force = &rests->force[row], against[] = {-force[0], -force[1]};
  struct PlaneState state = state_of_row(rests, row);
  bool has_force = hypot(force[0], force[1]) > 0.0, is_slow = *part_of_plane(rests->resolution, &state) == IS_SLOW;
  if (is_slow && plane_moves(&state)) plane_slide(rests->resolution, &state);
  else plane_slip(rests->resolution, &state, has_force ? against : &rests->behind[row]);
}

/* Lets frictions that do not slip stick by their constraints alone. */
static void let_planes_rest(struct PlaneRests *rests) {
  for (size_t row = 0; row < rests->n; row += 2) {
    struct PlaneState state = state_of_row(rests, row);
    if (!slips(rests, row)) plane_stick(rests->resolution, &state);
  }
}

/*
 * Lets frictions that do not slip stick with the forces that were found, and contacts carry those that balance them. The
 * constraints of all then begin with 0, and do not redistribute what was found. False if accelerations do not exist.
 */
static bool let_all_carry(struct PlaneRests *rests) {
  struct Resolution *resolution = rests->resolution;
  for (size_t row = 0; row < rests->n; row += 2) {
    if (slips(rests, row)) continue;
    struct PlaneState state = state_of_row(rests, row);
    const double load[] = {-rests->force[row], -rests->force[row + 1]};
    state.sliding = limit_at(rests, row, rests->given_kinetic, rests->kinetic);
    plane_carry(resolution, &state, load);
    plane_release(resolution, &state);
  }
  if (!plane_evaluate(resolution)) return false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (contact_is_closed(resolution, i)) contact_carry(resolution, i, contact_force(resolution, i));
  for (size_t row = 0; row < rests->n; row += 2) {
    struct PlaneState state = state_of_row(rests, row);
    if (!slips(rests, row)) plane_hold(resolution, &state);
  }
  return true;
}

/*
 * Weak frictions are those whose contacts are about to open. They keep their forces without constraints if others
 * constrain their velocities. Their constraints would take too much of a changing load again and again. False if that
 * cannot be determined.
 */
static bool release_weak(struct PlaneRests *rests) {
  double most = largest_stiction(rests->resolution);
  bool is_determined = true;
  for (size_t row = 0; row < rests->n && is_determined; row += 2) {
    struct PlaneState state = state_of_row(rests, row);
    bool is_constrained = false;
    if (slips(rests, row) || state.stiction >= weak_share * most) continue;
    plane_release(rests->resolution, &state);
    is_determined = frictions_find_constrained(rests->resolution, state.metadata->along, &is_constrained);
    if (!is_constrained) plane_hold(rests->resolution, &state);
  }
  return is_determined;
}

/* Sets the modes by the solution. False if accelerations do not exist. */
static bool take_rests(struct PlaneRests *rests) {
  for (size_t row = 0; row < rests->n; row += 2)
    if (slips(rests, row)) let_slip(rests, row);
  let_planes_rest(rests);
  if (!plane_evaluate(rests->resolution)) return false;
  if (all_stick(rests->resolution)) return true;
  return let_all_carry(rests) && release_weak(rests);
}

/* Lets frictions without kinetic friction slip if they need more than their stiction. */
static void release_others(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    if (*part_of_plane(resolution, &state) == 0.0 || has_unknown_force(resolution, &state)) continue;
    if (state.needed > state.stiction) plane_slip(resolution, &state, state.force);
  }
}

/*
 * Lets frictions slide whose constraint cannot stop the motion, as that of a slider at the dead centre of its crank.
 * They accelerate although they stick, or would need an enormous force.
 */
static void release_passing(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->plane_count; i++) {
    struct PlaneState state = plane_state(resolution, i);
    double *part = part_of_plane(resolution, &state);
    bool passes = continues(resolution, &state);
    bool is_hopeless = *part == IS_SLOW && state.needed > hopeless * state.stiction;
    if (*part == 0.0 || !(passes || is_hopeless)) continue;
    *part = 0.0;
    if (plane_moves(&state)) plane_slide(resolution, &state);
    else plane_slip(resolution, &state, passes ? state.rate : state.force);
  }
}

/* Finds the modes where not all can stick. False if that fails. */
static bool find_slips(struct Resolution *resolution) {
  struct PlaneRests rests;
  release_passing(resolution);
  release_others(resolution);
  if (!create_rests(resolution, &rests)) return false;
  bool is_done = rests.n == 0 || (solve_law(&rests) && take_rests(&rests));
  scratch_return(resolution->instance, SCRATCH_RESTS);
  return is_done;
}

bool plane_rests_find(struct Resolution *resolution) {
  choose_at_rest(resolution);
  if (!try_to_stick(resolution)) return false;
  return (all_stick(resolution) || find_slips(resolution)) && bring_to_rest(resolution);
}
