#include "planes/plane_state.h"

#include <math.h>

#include "evaluation/evaluate.h"

/* In units of the tolerance and the scale of the speed: speeds that count as small, and as 0. */
static const double small_share = 10.0, no_share = 0.1;
/* In units of the small speed: frictions up to this speed come to rest together with a slow one. */
static const double slow_share = 10.0;
/* Least tolerances for these speeds, of methods and of importers, which do not reach smaller ones. */
static const double least_tolerance = 1e-11, least_tolerance_in_exchange = 1e-6;
/* A slow friction that cannot stick is tried again at this fraction of its speed. */
static const double slower_share = 0.1;

/* Slip directions whose length differs from 1 by less are unit vectors but for rounding. */
static const double least_part = 1e-9;

/*
 * Values of the mode upper. never: no velocity reaches it. turned_aside: the mode may change as the velocity turns by
 * 90 degrees from the slip direction at which it began, so that an importer that steps over rest does not miss it.
 */
static const double never = -1e300, turned_aside = -1e-300;
/*
 * Slope: a velocity that has turned back at less than this slope to the slip direction, without an impact, has passed
 * rest.
 */
static const double slope_back = 0.5;

static double tolerance_of(const struct Instance *instance) {
  double least = instance->kind == KIND_MODEL_EXCHANGE ? least_tolerance_in_exchange : least_tolerance;
  return fmax(instance->situation->tolerance, least);
}

struct PlaneState plane_state(const struct Settlement *settlement, size_t plane) {
  const struct SwitchTable *switches = settlement->switches;
  const struct PlaneFacts *facts = &switches->planes[plane];
  struct PlaneState state = {.facts = facts,
                             .mode = (int)mode_of(settlement, switches->frictions[facts->along].mode),
                             .speed = speed_in_plane(settlement, facts->along),
                             .lower = mode_of(settlement, facts->lower),
                             .upper = mode_of(settlement, facts->upper)};
  for (size_t i = 0; i < 2; i++) {
    size_t place = friction_place(switches, facts->along + i, 0);
    state.velocity[i] = settlement->value[place + FRICTION_VELOCITY];
    state.rate[i] = settlement->value[place + FRICTION_RATE];
    state.stiction = settlement->value[place + FRICTION_STICTION];
    state.sliding = settlement->value[place + FRICTION_FORCE];
    size_t constraint = switches->frictions[facts->along + i].constraint;
    state.force[i] = settlement->acceleration[lagrangian.coordinate_count + constraint] +
                     mode_of(settlement, facts->heading[i]) * state.sliding;
  }
  double c = mode_of(settlement, facts->heading[0]), s = mode_of(settlement, facts->heading[1]);
  state.ahead = c * state.velocity[0] + s * state.velocity[1];
  state.aside = fabs(c * state.velocity[1] - s * state.velocity[0]);
  state.needed = hypot(state.force[0], state.force[1]);
  state.has_force = switches->rests_on == NULL || state.stiction != 0.0 || state.sliding != 0.0;
  state.is_free = state.mode == PLANE_HEADS && state.upper < 0.0;
  double unit = tolerance_of(settlement->instance) * settlement->value[plane_place(switches, plane)];
  state.small = small_share * unit;
  state.none = no_share * unit;
  state.has_slowed = is_hit(settlement, friction_indicator(switches, facts->along));
  state.has_sped = is_hit(settlement, friction_indicator(switches, facts->along + 1));
  bool may_have_turned = state.mode == PLANE_SLIDES && state.upper == turned_aside && !settlement->jumped;
  state.has_turned_back = may_have_turned && state.aside < -slope_back * state.ahead;
  state.is_given = switches->frictions[facts->along].is_given;
  state.is_first = settlement->flips[friction_indicator(switches, facts->along)] == 0.0;
  return state;
}

/* At the start velocities are given: what slides is not brought to rest. */
bool plane_is_slow(const struct Settlement *settlement, const struct PlaneState *state) {
  if (settlement->occasion == AT_START) return state->speed <= state->none;
  return state->speed <= slow_share * state->small || state->has_turned_back;
}

bool plane_evaluate(struct Settlement *settlement) {
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return false;
  return settlement_values(settlement, settlement->state, settlement->value);
}

void plane_count_switch(struct Settlement *settlement, const struct PlaneState *state) {
  settlement->flips[friction_indicator(settlement->switches, state->facts->along)]++;
}

static void set_plane_mode(struct Settlement *settlement, const struct PlaneState *state, enum PlaneMode mode,
                           double lower, double upper) {
  settlement_set_mode(settlement, settlement->switches->frictions[state->facts->along].mode, mode);
  settlement_set_mode(settlement, state->facts->lower, lower);
  settlement_set_mode(settlement, state->facts->upper, upper);
}

void plane_hold(struct Settlement *settlement, const struct PlaneState *state) {
  set_plane_mode(settlement, state, PLANE_STICKS, state->is_given ? 3.0 * state->none : state->none, never);
}

void plane_carry(struct Settlement *settlement, const struct PlaneState *state, const double force[2]) {
  plane_hold(settlement, state);
  for (int i = 0; i < 2; i++) {
    double share = force[i] != 0.0 ? force[i] / state->sliding : 0.0;
    settlement_set_mode(settlement, state->facts->heading[i], share);
  }
}

void plane_stick(struct Settlement *settlement, const struct PlaneState *state) {
  const double nothing[] = {0.0, 0.0};
  plane_carry(settlement, state, nothing);
}

void plane_push(struct Settlement *settlement, const struct PlaneState *state) {
  set_plane_mode(settlement, state, PLANE_HEADS, 3.0 * state->none, 3.0 * state->none);
}

bool plane_has_part(const struct Settlement *settlement, const struct PlaneState *state) {
  double share = hypot(mode_of(settlement, state->facts->heading[0]), mode_of(settlement, state->facts->heading[1]));
  return share < 1.0 - least_part;
}

/* Sets the slip direction. A direction of 0 keeps the present one, or takes that along if there is none. */
static void set_heading(struct Settlement *settlement, const struct PlaneState *state, const double heading[2]) {
  const double any[] = {1.0, 0.0};
  const size_t *mode = state->facts->heading;
  double length = hypot(heading[0], heading[1]),
         kept = hypot(mode_of(settlement, mode[0]), mode_of(settlement, mode[1]));
  if (!(length > 0.0) && kept > 0.0) return;
  for (int i = 0; i < 2; i++) settlement_set_mode(settlement, mode[i], length > 0.0 ? heading[i] / length : any[i]);
}

void plane_slide(struct Settlement *settlement, const struct PlaneState *state) {
  bool is_exchanged = settlement->instance->kind == KIND_MODEL_EXCHANGE;
  double slower = fmax(slower_share * state->speed, state->none);
  set_heading(settlement, state, state->velocity);
  if (state->speed > 2.0 * state->small)
    set_plane_mode(settlement, state, PLANE_SLIDES, state->small, is_exchanged ? turned_aside : never);
  else set_plane_mode(settlement, state, PLANE_SLIDES, slower, 4.0 * state->small);
}

void plane_free(struct Settlement *settlement, const struct PlaneState *state) {
  set_plane_mode(settlement, state, PLANE_HEADS, -never, never);
}

void plane_head(struct Settlement *settlement, const struct PlaneState *state, const double heading[2]) {
  set_heading(settlement, state, heading);
  plane_push(settlement, state);
}
