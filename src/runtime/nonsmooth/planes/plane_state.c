#include "nonsmooth/planes/plane_state.h"

#include <math.h>

#include "evaluation/evaluate.h"

/* Speeds that count as small, and as 0, in units of the tolerance times the scale of the speed. */
static const double small_share = 10.0, no_share = 0.1;
/* Frictions up to this speed, in units of the small speed, come to rest together with a slow one. */
static const double slow_share = 10.0;
/* Least tolerances for these speeds, of methods and of importers, which do not reach smaller ones. */
static const double least_tolerance = 1e-11, least_tolerance_in_exchange = 1e-6;
/* A slow friction that cannot stick is tried again at this fraction of its speed. */
static const double slower_share = 0.1;
/*
 * The solver of an importer starts anew as the speed grows by this factor, until it is `fast` small speeds. The rates by
 * friction are like 1 / speed. A solver that keeps the Jacobian of a lower speed, as CVODE does, makes too small steps
 * of Newton's method, and takes them for converged. Its error grows to several percent.
 */
static const double faster_factor = 10.0, fast = 1e4;

/* Slip directions whose length differs from 1 by less are unit vectors up to rounding. */
static const double least_part = 1e-9;

/* In m/s or rad/s: no velocity reaches this bound. */
static const double unreached = 1e300;

/*
 * A velocity that has turned back without an impact may have passed rest. It has if its component across the slip
 * direction is less than this fraction of the component against it.
 */
static const double slope_back = 0.5;

static bool importer_integrates(const struct Instance *instance) {
  return instance->kind == KIND_MODEL_EXCHANGE;
}

static double tolerance_of(const struct Instance *instance) {
  double least = importer_integrates(instance) ? least_tolerance_in_exchange : least_tolerance;
  return fmax(instance->fmu_state->tolerance, least);
}

struct PlaneState plane_state(const struct Resolution *resolution, size_t plane) {
  const struct SwitchTable *switches = resolution->switches;
  const struct PlaneMetadata *metadata = &switches->planes[plane];
  struct PlaneState state = {.metadata = metadata,
                             .mode = plane_mode(resolution, metadata),
                             .speed = speed_in_plane(resolution, metadata->along),
                             .lower = mode_of(resolution, metadata->lower),
                             .upper = mode_of(resolution, metadata->upper)};
  for (size_t i = 0; i < 2; i++) {
    size_t slot = friction_slot(switches, metadata->along + i, 0);
    state.velocity[i] = resolution->value[slot + FRICTION_VELOCITY];
    state.rate[i] = resolution->value[slot + FRICTION_RATE];
    state.stiction = resolution->value[slot + FRICTION_STICTION];
    state.sliding = resolution->value[slot + FRICTION_FORCE];
    size_t constraint = switches->frictions[metadata->along + i].constraint;
    state.force[i] = resolution->acceleration[lagrangian.coordinate_count + constraint] +
                     mode_of(resolution, metadata->slip_direction[i]) * state.sliding;
  }
  double c = mode_of(resolution, metadata->slip_direction[0]), s = mode_of(resolution, metadata->slip_direction[1]);
  state.ahead = c * state.velocity[0] + s * state.velocity[1];
  state.aside = fabs(c * state.velocity[1] - s * state.velocity[0]);
  state.needed = hypot(state.force[0], state.force[1]);
  state.has_force = switches->rests_on == NULL || state.stiction != 0.0 || state.sliding != 0.0;
  for (size_t i = 0; i < switches->contact_count && !state.has_force; i++)
    state.has_force = rests_on(switches, metadata->along, i) && contact_holds(resolution->instance, i);
  double unit = tolerance_of(resolution->instance) * resolution->value[plane_slot(switches, plane)];
  state.small = small_share * unit;
  state.none = no_share * unit;
  state.has_slowed = is_hit(resolution, friction_indicator(switches, metadata->along));
  state.has_sped = is_hit(resolution, friction_indicator(switches, metadata->along + 1));
  bool may_have_reversed = plane_slides(&state) && importer_integrates(resolution->instance) && !resolution->jumped;
  state.has_reversed = may_have_reversed && state.aside < -slope_back * state.ahead;
  state.is_given = switches->frictions[metadata->along].is_given;
  state.is_first = resolution->flips[friction_indicator(switches, metadata->along)] == 0.0;
  return state;
}

/* At the start the velocities are given, and a sliding friction is not brought to rest. */
bool plane_is_slow(const struct Resolution *resolution, const struct PlaneState *state) {
  if (resolution->occasion == AT_START) return state->speed <= state->none;
  return state->speed <= slow_share * state->small || state->has_reversed;
}

bool plane_evaluate(struct Resolution *resolution) {
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  return resolution_values(resolution, resolution->state, resolution->value);
}

void plane_count_switch(struct Resolution *resolution, const struct PlaneState *state) {
  resolution->flips[friction_indicator(resolution->switches, state->metadata->along)]++;
}

/* Sets the mode, and the speeds or velocities at which it may change. */
static void set_plane_mode(struct Resolution *resolution, const struct PlaneState *state, enum PlaneMode mode,
                           double lower, double upper) {
  resolution_set_mode(resolution, resolution->switches->frictions[state->metadata->along].mode, mode);
  resolution_set_mode(resolution, state->metadata->lower, lower);
  resolution_set_mode(resolution, state->metadata->upper, upper);
}

void plane_carry(struct Resolution *resolution, const struct PlaneState *state, const double force[2]) {
  set_plane_mode(resolution, state, PLANE_STICKS, state->is_given ? 3.0 * state->none : state->none, -unreached);
  for (int i = 0; i < 2; i++) {
    double share = state->sliding > 0.0 ? force[i] / state->sliding : 0.0;
    resolution_set_mode(resolution, state->metadata->slip_direction[i], share);
  }
}

void plane_stick(struct Resolution *resolution, const struct PlaneState *state) {
  const double nothing[] = {0.0, 0.0};
  plane_carry(resolution, state, nothing);
}

void plane_release(struct Resolution *resolution, const struct PlaneState *state) {
  double share = hypot(mode_of(resolution, state->metadata->slip_direction[0]),
                       mode_of(resolution, state->metadata->slip_direction[1]));
  enum PlaneMode mode = share < 1.0 - least_part ? PLANE_CARRIES : PLANE_IMPENDS;
  set_plane_mode(resolution, state, mode, 3.0 * state->none, 3.0 * state->none);
}

/* Sets the slip direction. A direction of 0 keeps the present one, or selects the first axis if there is none. */
static void set_slip_direction(struct Resolution *resolution, const struct PlaneState *state,
                               const double slip_direction[2]) {
  const double any[] = {1.0, 0.0};
  const size_t *mode = state->metadata->slip_direction;
  double length = hypot(slip_direction[0], slip_direction[1]),
         kept = hypot(mode_of(resolution, mode[0]), mode_of(resolution, mode[1]));
  if (!(length > 0.0) && kept > 0.0) return;
  for (int i = 0; i < 2; i++)
    resolution_set_mode(resolution, mode[i], length > 0.0 ? slip_direction[i] / length : any[i]);
}

void plane_slide(struct Resolution *resolution, const struct PlaneState *state) {
  bool is_small = state->speed <= 2.0 * state->small, is_integrated = importer_integrates(resolution->instance);
  double lower = is_small ? fmax(slower_share * state->speed, state->none) : state->small;
  set_slip_direction(resolution, state, state->velocity);
  if (is_integrated && !is_small && state->speed < fast * state->small)
    set_plane_mode(resolution, state, PLANE_CREEPS, lower, faster_factor * state->speed);
  else if (is_small) set_plane_mode(resolution, state, PLANE_CREEPS, lower, 4.0 * state->small);
  /* The velocity turns by 90 degrees from the slip direction as an importer steps over rest: it must not miss that. */
  else set_plane_mode(resolution, state, PLANE_SLIDES, lower, is_integrated ? 0.0 : -unreached);
}

void plane_free(struct Resolution *resolution, const struct PlaneState *state) {
  set_plane_mode(resolution, state, PLANE_IS_FREE, unreached, -unreached);
}

void plane_slip(struct Resolution *resolution, const struct PlaneState *state, const double slip_direction[2]) {
  set_slip_direction(resolution, state, slip_direction);
  plane_release(resolution, state);
}
