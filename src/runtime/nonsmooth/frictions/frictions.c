/*
 * Modes of dry friction along lines: 0 if it sticks, else the sign of its velocity. By Coulomb's law a friction
 * sticks while the force of its constraint is within the stiction. It slides while its velocity, or at rest its
 * acceleration, has the sign of its mode. The accelerations for given modes make this a complementarity problem,
 * which is solved by Murty's least-index method. Each round switches the first friction that disagrees, and the
 * accelerations are evaluated again. For linear complementarity problems with a P-matrix it ends (Cottle, Pang and
 * Stone, The Linear Complementarity Problem, chapter 4). Beyond FRICTION_FLIP_LIMIT switches of one friction jams.c
 * tries all modes; if that fails too, the motion ends with a message.
 */
#include "nonsmooth/frictions/frictions.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "detection/indicators.h"
#include "nonsmooth/frictions/jams.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/planes.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "nonsmooth/continuity.h"

/* The sign of a force below this number of rounding error bounds is not determined. */
static const double least_certainty = 4.0;

const double sticking_rate_share = 1e-6;

/* Forces below this share of the largest constraint force may be left by cancellation. */
static const double negligible_force = 1e-12;

/* Ratio of the forces while a friction slides to those while it sticks, beyond which it is jammed. */
static const double jammed_force = 1e6;

static const char neither[] = "a friction chatters";

/* What determines the mode of a friction. began: its mode before the event. */
struct FrictionState {
  double mode, began, velocity, rate;
  double force;     /* of its constraint, if it sticks: towards the nearer limit */
  double direction; /* -1 or 1: in which it slides, or would slide beyond that limit */
  double stiction;  /* in this direction */
  double error_bound, error_bound_of_rate, error_bound_of_force; /* rounding error bounds */
  double rounding_at_limit;                                      /* of the force beside its limit */
  double largest_rate;                                           /* since the start of the event */
  bool is_hit;        /* the zero of its velocity was located, or its limit was reached */
  bool is_first;      /* it has not switched in this event resolution */
  bool may_jump;      /* its velocity may have jumped, or the simulation starts */
  bool is_near_limit; /* the force is, as located; others may have taken a share of it since */
  bool is_moving;     /* faster than rounding errors */
  bool has_no_force;  /* as with mu = 0: rounding would decide on sticking */
  bool has_share;     /* at rest it acts with a share of its force, as others constrain its velocity */
};

static void take_direction(const struct Resolution *resolution, size_t friction, struct FrictionState *state) {
  size_t slot = friction_slot(resolution->switches, friction, 0);
  const double *value = &resolution->value[slot], *error_bound = &resolution->error_bound[slot];
  double force = force_on_line(resolution, friction);
  double middle = 0.5 * (value[FRICTION_STICTION] - value[FRICTION_STICTION_BACK]);
  state->direction = state->mode != 0.0 ? state->mode : force > middle ? 1.0 : -1.0;
  size_t stiction = state->direction < 0.0 ? FRICTION_STICTION_BACK : FRICTION_STICTION;
  state->stiction = fmax(value[stiction], 0.0); /* may be negative by rounding where mu |N| passes through 0 */
  if (state->mode != 0.0) return;
  state->force = state->direction * force;
  state->error_bound_of_force = resolution->force_error_bound[friction] + error_bound[stiction];
  state->rounding_at_limit = rounding_at_limit(resolution->instance, resolution->acceleration, friction);
}

/* True if a velocity is larger than a kink of the constraints or an error of the method can cause. */
static bool is_off_zero(const struct Resolution *resolution, double velocity) {
  return fabs(velocity) > resolution->tolerances.kink;
}

/* True if a velocity at 0 has a rate, beyond its rounding error and that of rates which constraints hold at 0. */
static bool leaves_rest(const struct Resolution *resolution, double rate, double error_bound) {
  return fabs(rate) > fmax(error_bound, resolution->tolerances.acceleration);
}

static struct FrictionState friction_state(const struct Resolution *resolution, size_t friction) {
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  size_t slot = friction_slot(resolution->switches, friction, FRICTION_VELOCITY);
  size_t indicator = friction_indicator(resolution->switches, friction);
  const double *value = &resolution->value[slot], *error_bound = &resolution->error_bound[slot];
  struct FrictionState state = {.mode = mode_of(resolution, metadata->mode),
                                .began = resolution->began[friction],
                                .velocity = value[FRICTION_VELOCITY],
                                .rate = value[FRICTION_RATE],
                                .error_bound = error_bound[FRICTION_VELOCITY],
                                .error_bound_of_rate = error_bound[FRICTION_RATE],
                                .largest_rate = resolution->largest[slot + FRICTION_RATE],
                                .is_hit = is_hit(resolution, indicator),
                                .is_first = resolution->flips[indicator] == 0.0,
                                .may_jump =
                                    resolution->jumped || resolution->occasion == AT_START ||
                                    (may_change_gaps(resolution) && is_off_zero(resolution, value[FRICTION_VELOCITY]))};
  take_direction(resolution, friction, &state);
  state.is_near_limit = !resolution->has_stuck_again || !metadata->has_static_limit ||
                        state.force > (1.0 - sticking_rate_share) * state.stiction;
  /* A friction force that varies passes through 0 and is nonzero the next moment. */
  bool may_stay = resolution->switches->rests_on != NULL || !resolution->switches->friction_varies;
  state.has_no_force = may_stay && value[FRICTION_STICTION] == 0.0 && value[FRICTION_FORCE] == 0.0 &&
                       value[FRICTION_STICTION_BACK] == 0.0 && value[FRICTION_FORCE_BACK] == 0.0;
  /* Rounding of the time, at the rate of this velocity before the event. */
  double error_bound_in_time = 8.0 * DBL_EPSILON * fabs(resolution->time * resolution->first_rate[friction]);
  /* After the velocity has reached 0, a remainder counts as a rounding error, until velocities jump. */
  bool is_at_zero = !state.is_first || state.is_hit;
  double rounding = state.error_bound + error_bound_in_time;
  bool is_faster = fabs(state.velocity) > rounding;
  /* Without force nothing stops a remainder: only one that the search leaves counts as 0. */
  if (is_at_zero && !state.may_jump)
    is_faster = state.has_no_force && fabs(state.velocity) > FLOOR_IN_ERROR_BOUND * rounding;
  state.is_moving = is_faster;
  state.has_share = state.mode != 0.0 && carried_share(resolution->instance, friction) != 0.0;
  return state;
}

/*
 * Returns the mode of a friction without force, which never sticks. Its contact may have no force because the friction
 * sticks, as where the head of a ladder carries its share of the weight. Then that share has the direction.
 */
static double mode_without_force(const struct FrictionState *state) {
  bool has_direction = state->mode == 0.0 && state->force > state->error_bound_of_force;
  double next = state->is_moving                                 ? state->velocity
                : has_direction                                  ? state->direction
                : fabs(state->rate) > state->error_bound_of_rate ? state->rate
                : state->is_hit && state->is_first               ? -state->mode
                                                                 : state->mode;
  return next < 0.0 ? -1.0 : 1.0;
}

/*
 * Returns the mode of a friction whose constraint does not hold its velocity; 0 for others. It may contradict others, as
 * that of a brake against a clutch that begins to turn. The rate then is that with which the others move it. Or it passes
 * through 0 because it cannot stop the motion, as at the dead centre of a crank. The rate then is the same while it
 * sticks, and the constraint force is a rounding error.
 */
static double mode_without_hold(const struct Resolution *resolution, const struct FrictionState *state) {
  /* Exactly at a dead centre the rate is not determined: beside it an enormous force holds the velocity. */
  bool continues = fabs(state->rate) > sticking_rate_share * state->largest_rate,
       is_determined = fabs(state->rate) > state->error_bound_of_rate ||
                       state->error_bound_of_force > jammed_force * state->stiction;
  bool is_rounding = fabs(state->force) <= least_certainty * state->error_bound_of_force;
  bool has_slid = !state->is_first && state->began != 0.0;
  double most = continues ? state->error_bound_of_force : state->force;
  if (continues && is_determined && (has_slid || fabs(state->rate) > resolution->tolerances.acceleration))
    return state->rate > 0.0 ? 1.0 : -1.0;
  return has_slid && state->is_hit && is_rounding && most > state->stiction ? -state->began : 0.0;
}

/* True if a friction that sticks begins to slide. */
static bool is_overcome(const struct Resolution *resolution, const struct FrictionState *state) {
  bool is_located = state->is_hit && state->is_first, has_come_to_rest = state->is_hit && !state->is_first;
  /* At the limit a friction sticks, within rounding, unless its event was located there. Importers stop beyond it. */
  double rounding = is_located || resolution->occasion == IN_EXCHANGE ? 0.0 : state->rounding_at_limit;
  if (has_come_to_rest) rounding = state->error_bound_of_force;
  double limit = state->stiction + rounding;
  bool has_reached = is_located && state->is_near_limit && !resolution->jumped;
  return state->force > limit || has_reached;
}

/* Returns the mode of a friction that sticks: 0, or the direction in which it begins to slide. */
static double mode_from_rest(const struct Resolution *resolution, const struct FrictionState *state) {
  double passing = mode_without_hold(resolution, state);
  if (passing != 0.0) return passing;
  return is_overcome(resolution, state) ? state->direction : 0.0;
}

bool friction_rests(const struct Resolution *resolution, size_t friction) {
  struct FrictionState state = friction_state(resolution, friction);
  return state.mode == 0.0 || !state.is_moving;
}

bool friction_is_even(const struct Resolution *resolution, size_t friction) {
  const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
  if (is_in_plane(resolution->switches, friction) || resolution->switches->frictions[friction].is_given) return false;
  return value[FRICTION_STICTION] == value[FRICTION_STICTION_BACK] &&
         value[FRICTION_FORCE] == value[FRICTION_FORCE_BACK];
}

bool friction_rests_at_limit(const struct Resolution *resolution, size_t friction) {
  struct FrictionState state = friction_state(resolution, friction);
  bool is_still = !state.is_moving && fabs(state.rate) <= state.error_bound_of_rate;
  bool is_at_limit = state.mode != 0.0 && !state.has_share;
  return is_at_limit && is_still && !state.has_no_force && friction_is_even(resolution, friction);
}

bool friction_is_overcome(const struct Resolution *resolution, size_t friction) {
  if (!friction_is_even(resolution, friction)) return false;
  struct FrictionState state = friction_state(resolution, friction);
  if (state.mode != 0.0 || state.has_no_force || (state.is_moving && state.may_jump)) return false;
  return mode_without_hold(resolution, &state) == 0.0 && is_overcome(resolution, &state);
}

/* Returns the mode of a friction that slides at a velocity that has not jumped. */
static double mode_from_sliding(const struct Resolution *resolution, const struct FrictionState *state) {
  bool reverses = (state->is_moving && state->mode * state->velocity < 0.0) || state->is_hit;
  if (state->is_moving && !reverses) return state->mode;
  if (resolution->occasion == AT_START && state->is_first) return 0.0;
  double least_rate = -state->error_bound_of_rate - state->error_bound / shortest_slip;
  bool leaves = !state->is_moving && state->mode * state->rate >= least_rate && (!reverses || !state->is_first);
  return leaves ? state->mode : 0.0;
}

/* Returns the mode of a friction that acts with a share of its force: it sticks once its velocity is not constrained. */
static double mode_with_share(const struct Resolution *resolution, const struct FrictionState *state) {
  if (state->is_moving) return state->velocity > 0.0 ? 1.0 : -1.0;
  return leaves_rest(resolution, state->rate, state->error_bound_of_rate) ? 0.0 : state->mode;
}

/* Returns the mode that agrees with Coulomb's law; the present one if nothing contradicts it. */
static double friction_mode(const struct Resolution *resolution, const struct FrictionState *state) {
  if (state->has_share) return mode_with_share(resolution, state);
  if (state->has_no_force) return mode_without_force(state);
  if (state->is_moving && state->may_jump) return state->velocity > 0.0 ? 1.0 : -1.0;
  return state->mode == 0.0 ? mode_from_rest(resolution, state) : mode_from_sliding(resolution, state);
}

const char *frictions_report_inconsistent(const struct Resolution *resolution, size_t friction) {
  const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
  bool is_weaker =
      value[FRICTION_STICTION] < value[FRICTION_FORCE] || value[FRICTION_STICTION_BACK] < value[FRICTION_FORCE_BACK];
  log_message(resolution->instance, STATUS_DISCARD,
              "time %g: the friction '%s' neither sticks nor slides; expected %sless friction, or another position",
              resolution->time, resolution->switches->frictions[friction].name,
              is_weaker ? "a stiction of at least the force while it slides, " : "");
  return neither;
}

void frictions_report_missing(const struct Resolution *resolution, const char *missing) {
  const struct SwitchTable *switches = resolution->switches;
  size_t worst = 0;
  for (size_t i = 1; i < switches->friction_count; i++)
    if (resolution->flips[friction_indicator(switches, i)] > resolution->flips[friction_indicator(switches, worst)])
      worst = i;
  log_message(resolution->instance, STATUS_DISCARD,
              "time %g: no %s are found for the frictions, of which '%s' switched most; expected less friction, or "
              "another position",
              resolution->time, missing, switches->frictions[worst].name);
}

void friction_switch(struct Resolution *resolution, size_t friction, double mode) {
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  bool is_constrained = false;
  set_friction(resolution, friction, mode);
  if (!metadata->has_static_limit || mode == 0.0) return;
  if (!frictions_find_constrained(resolution, friction, &is_constrained)) return; /* the next evaluation says why */
  resolution_set_mode(resolution, metadata->reported, is_constrained ? 0.0 : mode);
}

/*
 * Lets all frictions stick that act with their limits at rest, once in an event resolution. The forces of the others
 * follow from theirs, and may exceed their limits, though other forces within all limits hold the same load.
 */
static bool stick_again(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool changed = false;
  for (size_t i = 0; i < switches->friction_count && !resolution->has_stuck_again; i++) {
    if (!switches->frictions[i].has_static_limit) continue;
    struct FrictionState state = friction_state(resolution, i);
    if (state.mode == 0.0 || state.is_moving) continue;
    set_friction(resolution, i, 0.0);
    changed = true;
  }
  resolution->has_stuck_again = true;
  return changed;
}

bool frictions_slide_unheld(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (is_in_plane(switches, i) || switches->frictions[i].is_given || !friction_sticks(resolution, i)) continue;
    struct FrictionState state = friction_state(resolution, i);
    double mode = state.has_no_force ? 0.0 : mode_without_hold(resolution, &state);
    if (mode == 0.0 || state.is_moving || ++resolution->flips[friction_indicator(switches, i)] > FRICTION_FLIP_LIMIT)
      continue;
    friction_switch(resolution, i, mode);
    return true;
  }
  return false;
}

/* Lets all frictions stick that are at rest at the start, before those whose forces are too small begin to slide. */
static bool stick_at_start(struct Resolution *resolution) {
  bool changed = false;
  for (size_t i = 0; i < resolution->switches->friction_count && resolution->occasion == AT_START; i++) {
    if (is_in_plane(resolution->switches, i) || resolution->switches->frictions[i].is_given) continue;
    struct FrictionState state = friction_state(resolution, i);
    if (!state.is_first || state.mode == 0.0 || state.is_moving || state.has_no_force) continue;
    resolution->flips[friction_indicator(resolution->switches, i)]++;
    set_friction(resolution, i, 0.0);
    changed = true;
  }
  return changed;
}

/* Frictions that are overcome stay as they are where their forces are found with those of others. */
const char *frictions_act(struct Resolution *resolution, bool *switched) {
  const struct SwitchTable *switches = resolution->switches;
  bool keeps_overcome = switches->friction_laws->resolve_together != NULL;
  *switched = stick_at_start(resolution);
  for (size_t i = 0; i < switches->friction_count && !*switched; i++) {
    if (is_in_plane(switches, i) || switches->frictions[i].is_given) continue;
    struct FrictionState state = friction_state(resolution, i);
    double mode = friction_mode(resolution, &state);
    bool is_kept = mode == state.mode && !(state.has_share && state.is_moving);
    if (is_kept || (keeps_overcome && friction_is_overcome(resolution, i))) continue;
    if (++resolution->flips[friction_indicator(resolution->switches, i)] > FRICTION_FLIP_LIMIT) {
      *switched = jams_resolve(resolution) || resolution_ends_slip(resolution);
      return *switched                         ? NULL
             : resolution->has_several_motions ? neither
                                               : frictions_report_inconsistent(resolution, i);
    }
    *switched = state.mode == 0.0 && stick_again(resolution);
    if (*switched) return NULL;
    friction_switch(resolution, i, mode);
    *switched = true;
  }
  return NULL;
}

void frictions_release(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    double velocity = resolution->value[friction_slot(switches, i, FRICTION_VELOCITY)];
    if (switches->frictions[i].is_given || !friction_sticks(resolution, i) || !is_off_zero(resolution, velocity))
      continue;
    set_friction(resolution, i, velocity < 0.0 ? -1.0 : 1.0);
  }
}

/* Returns the number of active constraints that depend on others; SIZE_MAX if that cannot be determined. */
static size_t count_redundant(struct Resolution *resolution) {
  if (!resolution_find_correction(resolution)) return SIZE_MAX;
  const double *pivot = resolution->correction + lagrangian.coordinate_count + lagrangian.constraints.count;
  size_t count = 0;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) count += isinf(pivot[j]) && resolution_moves(resolution, j);
  return count;
}

bool frictions_find_constrained(struct Resolution *resolution, size_t friction, bool *is_constrained) {
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  double *mode = &resolution->instance->parameter[metadata->mode], kept = *mode;
  if (kept == 0.0) *mode = 1.0;
  resolution->instance->parameter_constants_are_stale = true;
  size_t without = count_redundant(resolution);
  *mode = 0.0;
  resolution->instance->parameter_constants_are_stale = true;
  size_t with = count_redundant(resolution), velocities = resolution_moves(resolution, metadata->constraint);
  if (is_in_plane(resolution->switches, friction)) velocities += resolution_moves(resolution, metadata[1].constraint);
  *mode = kept;
  resolution->instance->parameter_constants_are_stale = true;
  *is_constrained = with >= without + velocities;
  /* Later steps, such as projections, need the values for the restored modes. */
  bool is_restored = evaluate_prepare(resolution->instance) == STATUS_DONE;
  return is_restored && with != SIZE_MAX && without != SIZE_MAX;
}

/*
 * Reports frictions as sticking that slide without moving: other constraints hold their velocity, and forces are not
 * unique.
 */
bool frictions_report(struct Resolution *resolution, bool *again) {
  const struct SwitchTable *switches = resolution->switches;
  double slowest = resolution->tolerances.rest;
  *again = false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct FrictionMetadata *metadata = &switches->frictions[i];
    bool is_planar = is_in_plane(switches, i);
    double mode = mode_of(resolution, metadata->mode);
    if (is_planar && mode != 0.0) mode = 1.0;
    double velocity =
        is_planar ? speed_in_plane(resolution, i) : resolution->value[friction_slot(switches, i, FRICTION_VELOCITY)];
    bool is_constrained = false,
         may_rest = mode != 0.0 && !metadata->is_given && fabs(velocity) <= slowest && lagrangian.constraints.count > 1;
    bool is_at_limit = metadata->has_static_limit && mode_of(resolution, metadata->reported) == 0.0;
    size_t rate = friction_slot(switches, i, FRICTION_RATE);
    double least = fmax(resolution->error_bound[rate], sticking_rate_share * resolution->largest[rate]);
    if (!is_planar && !is_at_limit) may_rest &= !leaves_rest(resolution, resolution->value[rate], least);
    if (may_rest && !frictions_find_constrained(resolution, i, &is_constrained)) return false;
    if (is_planar) i++; /* the friction across has the same mode */
    if (is_constrained) mode = 0.0;
    if (mode == mode_of(resolution, metadata->reported)) continue;
    resolution_set_mode(resolution, metadata->reported, mode);
    *again = true;
  }
  return true;
}

/* Returns the rounding error of forces in which the largest one cancels. */
static double rounding_left_of_forces(const struct Resolution *resolution) {
  double largest = 0.0;
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    largest = fmax(largest, fabs(resolution->acceleration[lagrangian.coordinate_count + j]));
  return negligible_force * largest;
}

/* Returns the part of value[] with the force in the direction of sliding; at rest that of the smaller force. */
static size_t weaker_force(const struct Resolution *resolution, size_t friction) {
  const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
  double mode = mode_of(resolution, resolution->switches->frictions[friction].mode);
  bool is_back = mode == 0.0 ? value[FRICTION_FORCE_BACK] < value[FRICTION_FORCE] : mode < 0.0;
  return is_back ? FRICTION_FORCE_BACK : FRICTION_FORCE;
}

/* Perturbs all of the state by the tolerance, in one of two patterns. */
static void err_by_tolerance(const struct Resolution *resolution, bool otherwise, double *state) {
  double share = resolution->instance->fmu_state->tolerance;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double change = share * fmax(fabs(resolution->state[i]), lagrangian.steps.nominal[i]);
    state[i] = resolution->state[i] + ((otherwise ? i / 2 : i) % 2 == 0 ? change : -change);
  }
}

/*
 * True if errors of the tolerance in the state, and in the time since the inputs were set, can make this value 0. An
 * example is mu |N| where N passes through 0 and its branch has not switched yet; another the end of a ramp to 0.
 */
static bool is_within_error(struct Resolution *resolution, size_t slot) {
  const struct FmuState *fmu_state = resolution->instance->fmu_state;
  double most = 0.0, *value = resolution->other_error_bound;
  double late = fmu_state->tolerance * (resolution->time - fmu_state->time);
  for (int otherwise = 0; otherwise < 2; otherwise++) {
    err_by_tolerance(resolution, otherwise != 0, resolution->rounded);
    if (resolution_values_near(resolution, resolution->time - late, resolution->rounded, value))
      most = fmax(most, fabs(value[slot] - resolution->value[slot]));
  }
  return fabs(resolution->value[slot]) <= least_certainty * most;
}

/* True if a friction rests on a contact that pulls: the mode of a time step, until the next one opens it. */
static bool rests_on_pulling(const struct Resolution *resolution, size_t friction) {
  bool pulls = false;
  for (size_t i = 0; i < resolution->switches->contact_count && !pulls; i++)
    pulls = rests_on(resolution->switches, friction, i) && contact_holds(resolution->instance, i) &&
            contact_force(resolution, i) < 0.0;
  return pulls;
}

/* A negative friction force is a mistake of the model, such as a wrong sign of a force in it. */
const char *frictions_check(struct Resolution *resolution) {
  double rounding = rounding_left_of_forces(resolution);
  for (size_t i = 0; i < resolution->switches->friction_count; i++) {
    size_t slot = friction_slot(resolution->switches, i, weaker_force(resolution, i));
    double force = resolution->value[slot];
    if (!(force < -resolution->error_bound[slot] - rounding) || rests_on_pulling(resolution, i) ||
        is_within_error(resolution, slot))
      continue;
    log_message(resolution->instance, resolution_status(resolution),
                "time %g: the force of the friction '%s' is %g; expected 0 or more, such as abs(...)", resolution->time,
                resolution->switches->frictions[i].name, force);
    return "the force of a friction is negative";
  }
  return NULL;
}

/*
 * True if the force of a friction, and the indicator of a branch if there is one, depend on the force of a constraint.
 */
static bool follows_from(struct Resolution *resolution, size_t friction, size_t branch, size_t constraint) {
  const double *without = resolution->value, *with = resolution->other_error_bound;
  size_t slot = friction_slot(resolution->switches, friction, weaker_force(resolution, friction));
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  resolution_values_of_force(resolution, &point, constraint, 0.0, resolution->value);
  resolution_values_of_force(resolution, &point, constraint, 1.0, resolution->other_error_bound);
  bool reverses = branch == resolution->switches->branch_count || with[branch] != without[branch];
  return reverses && with[slot] != without[slot];
}

/* Returns the largest constraint force; INFINITY if accelerations do not exist. */
static double largest_force(struct Resolution *resolution) {
  double largest = 0.0;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return INFINITY;
  if (!resolution_values(resolution, resolution->state, resolution->other_error_bound)) return INFINITY;
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    largest = fmax(largest, fabs(resolution->acceleration[lagrangian.coordinate_count + j]));
  return largest;
}

/* True if forces are finite while the friction sticks, and infinite or much larger while it slides. */
static bool is_freed_by_sticking(struct Resolution *resolution, size_t friction) {
  double *mode = &resolution->instance->parameter[resolution->switches->frictions[friction].mode], kept = *mode;
  double sliding = largest_force(resolution);
  *mode = 0.0;
  resolution->instance->parameter_constants_are_stale = true;
  double sticking = largest_force(resolution);
  *mode = kept;
  resolution->instance->parameter_constants_are_stale = true;
  return isfinite(sticking) && sliding > jammed_force * sticking;
}

bool frictions_explain_jam(struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  size_t friction = 0, constraint = 0, pairs = switches->friction_count * lagrangian.constraints.count;
  bool jams = false;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  for (size_t pair = 0; pair < pairs && !jams; pair++) {
    friction = pair / lagrangian.constraints.count;
    constraint = pair % lagrangian.constraints.count;
    jams = mode_of(resolution, switches->frictions[friction].mode) != 0.0 &&
           follows_from(resolution, friction, branch, constraint) &&
           sliding_speed(resolution, friction) > resolution->tolerances.rest;
  }
  if (!jams || (branch == switches->branch_count && !is_freed_by_sticking(resolution, friction))) return false;
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: the force of the %s '%s' has no solution, as the friction '%s', which follows from it, slides, "
              "and both jam each other (Painleve's paradox); expected less friction, or another load",
              resolution->time, evaluate_kind(constraint), lagrangian.constraints.names[constraint],
              switches->frictions[friction].name);
  return true;
}

const struct FrictionLaws friction_laws = {.slide_unheld = frictions_slide_unheld,
                                           .act = frictions_act,
                                           .report = frictions_report,
                                           .report_missing = frictions_report_missing,
                                           .check = frictions_check,
                                           .release = frictions_release,
                                           .resolve_jam = jams_resolve,
                                           .explain_jam = frictions_explain_jam};
