#include "nonsmooth/branches.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "nonsmooth/continuity.h"
#include "detection/indicators.h"
#include "instance/active_constraints.h"
#include "instance/time_laws.h"

/* Switches of one branch in an event resolution before it counts as endless. */
enum { FLIP_LIMIT = 8 };

static const char endless_switching[] = "a mode switches without end (chattering)";

static const char jammed[] = "a friction and a constraint jam each other";

/* In s: an importer that is back at a zero sooner makes no progress. */
static const double soonest_return = 1e-6;

static double sign_with_error_bound(double value, double error_bound) {
  return value > error_bound ? 1.0 : value < -error_bound ? -1.0 : 0.0;
}

/* True if the indicator is the velocity of a friction with prescribed motion, which moved when the event began. */
static bool is_prescribed(const struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  bool is_prescribed = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    is_prescribed |= switches->frictions[i].is_given &&
                     switches->frictions[i].mode == switches->branches[branch].mode && resolution->began[i] != 0.0;
  return is_prescribed;
}

/*
 * Returns the rounding error bound of a branch. At a located zero it includes the floor of the search. It also does for
 * a prescribed motion that has come to rest, whose velocity has the rounding error of its path.
 */
static double error_bound_of_branch(const struct Resolution *resolution, size_t branch) {
  double error_bound = resolution_error_bound(resolution, branch, branch_rate_slot(resolution->switches, branch));
  bool is_rough = is_hit(resolution, branch) || is_prescribed(resolution, branch);
  return error_bound * (is_rough ? FLOOR_IN_ERROR_BOUND : 1.0);
}

/* True if an event has left the indicator a little beyond 0, and its rate leads back to the sign of its mode. */
static bool comes_back(const struct Resolution *resolution, size_t branch, double mode, double error_bound) {
  size_t rate = branch_rate_slot(resolution->switches, branch);
  double value = resolution->value[branch];
  return mode * sign_with_error_bound(value, error_bound) < 0.0 && fabs(value) <= FLOOR_IN_ERROR_BOUND * error_bound &&
         mode * resolution->value[rate] > resolution->error_bound[rate];
}

/* True if a branch at a located zero crosses it. The sign of an event's expression stays after other changes. */
static bool passes(const struct Resolution *resolution, size_t branch) {
  if (!is_hit(resolution, branch) || resolution->flips[branch] != 0.0 || resolution->jumped) return false;
  return !resolution->switches->branches[branch].is_last_sign || !resolution_has_changed(resolution);
}

/*
 * True if an indicator at 0 without a rate stays there. In this event a friction has begun to stick, or a velocity
 * or a prescribed motion in the indicator has come to rest.
 */
static bool stays_at_zero(const struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  bool has_stopped = is_prescribed(resolution, branch) && !resolution->is_beside_departure;
  bool rests = has_stopped || (resolution->has_rested && resolution->value[branch] == 0.0);
  for (size_t i = 0; i < switches->friction_count && !switches->branches[branch].is_last_sign; i++)
    rests |= resolution->began[i] != 0.0 && friction_holds(resolution->instance, i);
  return rests;
}

/*
 * Returns the rounding error bound of the rate of an indicator at 0. After a jump, even the smallest rate counts:
 * it is not left by rounding. A velocity that leaves rest as a friction slips begins with the difference of two
 * equal forces. Where a prescribed motion stops, constraints leave the difference of two equal accelerations.
 */
static double error_bound_of_rate(const struct Resolution *resolution, size_t branch, double error_bound) {
  bool leaves_rest = resolution->has_left_rest || (resolution->is_departure && is_hit(resolution, branch));
  if (resolution->jumped) return 0.0;
  double error_at_rest = leaves_rest || is_prescribed(resolution, branch) ? error_bound / shortest_slip : 0.0;
  return resolution->error_bound[branch_rate_slot(resolution->switches, branch)] + error_at_rest;
}

/*
 * True if the piece of the mode has no value here. Rounding has left the indicator on the other side of 0, where
 * the piece, such as a root, does not exist.
 */
static bool has_no_value(const struct Resolution *resolution, size_t branch, double mode) {
  double rate = resolution->value[branch_rate_slot(resolution->switches, branch)];
  bool moves = !isnan(rate) && are_finite(resolution_accelerations(resolution), lagrangian.coordinate_count);
  return !moves && mode * resolution->value[branch] < 0.0;
}

/* Returns the sign of an indicator: its own, or at 0 that of its rate. */
static double sign_of_branch(const struct Resolution *resolution, size_t branch) {
  size_t rate = branch_rate_slot(resolution->switches, branch);
  double mode = mode_of(resolution, resolution->switches->branches[branch].mode);
  double error_bound = error_bound_of_branch(resolution, branch);
  if (comes_back(resolution, branch, mode, error_bound)) return mode;
  double sign = sign_with_error_bound(resolution->value[branch], error_bound);
  if (sign != 0.0) return sign;
  sign = sign_with_error_bound(resolution->value[rate], error_bound_of_rate(resolution, branch, error_bound));
  if (sign != 0.0) return sign;
  if (passes(resolution, branch)) return mode == 0.0 ? resolution->instance->departure : -mode;
  /*
   * Values that were set to 0, without a rate, are at rest, whatever their sign was. With a rate, as of a root of
   * rounding errors, they are not.
   */
  bool was_set = (resolution->jumped || resolution->occasion != AT_EVENT) && resolution->flips[branch] < 2.0;
  return was_set || stays_at_zero(resolution, branch) ? 0.0 : mode;
}

/*
 * Returns the next mode of a branch: the sign of its indicator, if the piece of this sign has a value here. The event
 * resolution does not return to a piece without one.
 */
static double branch_mode(const struct Resolution *resolution, size_t branch) {
  double mode = mode_of(resolution, resolution->switches->branches[branch].mode);
  if (has_no_value(resolution, branch, mode)) {
    resolution->absent[branch] = mode;
    return -mode;
  }
  double sign = sign_of_branch(resolution, branch);
  return sign != 0.0 && sign == resolution->absent[branch] ? mode : sign;
}

/* Logs a branch both of whose signs lead back to its zero; returns the reason. */
static const char *report_branch(struct Resolution *resolution, size_t branch) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  const struct BranchMetadata *metadata = &resolution->switches->branches[branch];
  if (laws != NULL && laws->explain_jam(resolution, branch)) return jammed;
  if (continuity_explain_corner(resolution, branch)) return endless_switching;
  const char *remedy = lagrangian.coordinate_count > 0
                           ? "as with dry friction that sticks; expected <friction> in place of sign, or of a <state>"
                           : "as with a relay without hysteresis; expected";
  log_message(
      resolution->instance, resolution->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
      "time %g: %s, line %ld of %s, chatters: on both sides of its jump the motion leads back to it, %s a <mode> "
      "that two events set at different values",
      resolution->time, metadata->function, metadata->line, metadata->file, remedy);
  return endless_switching;
}

/*
 * True if the branch belongs to a sample that waits for the first event iteration. Modes have their start values in
 * initialization mode, as initial="exact" requires, and change in event mode (FMI 2.0.4, section 2.2.7; FMI 3.0.2,
 * section 2.4.7). Co-simulation without event mode samples as initialization ends.
 */
static bool waits_for_event_mode(const struct Resolution *resolution, size_t branch) {
  const struct Instance *instance = resolution->instance;
  bool has_event_mode = instance->kind == KIND_MODEL_EXCHANGE || instance->uses_event_mode;
  return resolution->occasion == AT_START && (instance->is_reading || has_event_mode) &&
         sample_of(resolution->switches, branch) != NULL;
}

const char *branches_switch(struct Resolution *resolution, bool last_signs, bool *switched) {
  const struct SwitchTable *switches = resolution->switches;
  *switched = false;
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (switches->branches[i].is_last_sign != last_signs || waits_for_event_mode(resolution, i)) continue;
    double mode = branch_mode(resolution, i);
    if (mode == mode_of(resolution, switches->branches[i].mode)) continue;
    if (++resolution->flips[i] > FLIP_LIMIT) {
      const struct FrictionLaws *laws = switches->friction_laws;
      *switched = laws != NULL && laws->resolve_jam(resolution);
      return *switched ? NULL : resolution->has_several_motions ? jammed : report_branch(resolution, i);
    }
    continuity_note(resolution, i);
    resolution->rate[i] = resolution->value[branch_rate_slot(switches, i)];
    resolution_set_mode(resolution, switches->branches[i].mode, mode);
    *switched = true;
  }
  return NULL;
}

/* Relative to the largest acceleration or force: at a located zero, smaller jumps are rounding errors. */
static const double least_jump = 1e-9;

/* True if count numbers are the same before and behind a zero; false if one is NAN. */
static bool numbers_stay(const double *before, const double *behind, size_t count) {
  double largest = 0.0;
  bool stay = true;
  for (size_t i = 0; i < count; i++) largest = fmax(largest, fmax(fabs(before[i]), fabs(behind[i])));
  for (size_t i = 0; i < count; i++) stay &= fabs(behind[i] - before[i]) <= least_jump * largest;
  return stay;
}

/* True if the last evaluation has the accelerations and the constraint forces of before. */
static bool accelerations_stay(const struct Resolution *resolution, const double *before) {
  const double *behind = resolution_accelerations(resolution);
  size_t n = lagrangian.coordinate_count;
  return numbers_stay(before, behind, n) && numbers_stay(before + n, behind + n, lagrangian.constraints.count);
}

/* True if the indicators in value[] have the signs of the modes of all branches, but for this one at its zero. */
static bool signs_stay(const struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  bool stay = true;
  for (size_t i = 0; i < switches->branch_count; i++)
    stay &= i == branch || resolution->value[i] * mode_of(resolution, switches->branches[i].mode) >= 0.0;
  return stay;
}

/* True if the event is the zero of a branch of forces, at which an importer has set nothing. */
static bool may_be_kink(const struct Resolution *resolution) {
  size_t branch = resolution->indicator;
  if (resolution->occasion != AT_EVENT || branch >= resolution->switches->branch_count) return false;
  const struct BranchMetadata *metadata = &resolution->switches->branches[branch];
  bool has_set = resolution->instance->fmu_state->changed == CHANGED_VALUES;
  return metadata->is_of_forces && mode_of(resolution, metadata->mode) != 0.0 && !has_set;
}

bool branches_pass_kink(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  if (!may_be_kink(resolution) || !resolution_find_accelerations(resolution)) return false;
  size_t branch = resolution->indicator, index = switches->branches[branch].mode;
  double mode = mode_of(resolution, index), *before = resolution->correction;
  size_t count = lagrangian.coordinate_count + lagrangian.constraints.count;
  memcpy(before, resolution_accelerations(resolution), count * sizeof *before);
  resolution_set_mode(resolution, index, -mode);
  if (resolution_find_accelerations(resolution) && accelerations_stay(resolution, before)) {
    struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
    switches->indicators(&point, resolution_accelerations(resolution), resolution->value);
    if (signs_stay(resolution, branch)) return true;
  }
  resolution_set_mode(resolution, index, mode);
  resolution->changed = false;
  return false;
}

const char *branches_check(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  if (resolution->occasion != IN_EXCHANGE || resolution->jumped || resolution->set_mode) return NULL;
  for (size_t i = 0; i < switches->branch_count; i++) {
    size_t slot = branch_rate_slot(switches, i);
    double mode = mode_of(resolution, switches->branches[i].mode), error_bound = resolution->error_bound[slot];
    double rate = resolution->value[slot];
    bool leads_back = mode * resolution->rate[i] > error_bound && mode * rate < -error_bound;
    if (leads_back && fabs(resolution->value[i]) <= soonest_return * fabs(rate)) return report_branch(resolution, i);
  }
  return NULL;
}

/*
 * Returns the sign of a branch at the start. At a kink of a gap, the rate gives the piece, which impacts need. An
 * event's expression at 0 has no sign yet.
 */
static double sign_at_start(const struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  size_t rate = branch_rate_slot(switches, branch);
  double sign = sign_with_error_bound(resolution->value[branch], resolution_error_bound(resolution, branch, rate));
  if (sign != 0.0 || switches->branches[branch].is_last_sign || switches->contact_laws == NULL) return sign;
  return sign_with_error_bound(resolution->value[rate], resolution->error_bound[rate]);
}

bool branches_begin(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool stay = false;
  for (size_t round = 0; round <= switches->branch_count && !stay; round++) {
    if (!resolution_evaluate(resolution)) return false;
    stay = true;
    for (size_t i = 0; i < switches->branch_count; i++) {
      double mode = waits_for_event_mode(resolution, i) ? 1.0 : sign_at_start(resolution, i);
      stay &= mode == mode_of(resolution, switches->branches[i].mode);
      resolution_set_mode(resolution, switches->branches[i].mode, mode);
    }
  }
  return true;
}

static void guess_branches(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Point point = instance_point(instance);
  double *value = resolution_of(instance).value;
  /* With a mode of 0, a mass could be 0. */
  for (size_t i = 0; i < switches->branch_count; i++)
    if (instance->parameter[switches->branches[i].mode] == 0.0) instance->parameter[switches->branches[i].mode] = 1.0;
  for (size_t round = 0; round <= switches->branch_count; round++) {
    if (lagrangian.prepare(instance->parameter, instance->parameter_constants) != 0) return;
    if (switches->feels_forces && lagrangian.constraints.accelerations(&point, instance->acceleration) != 0) return;
    switches->indicators(&point, instance->acceleration, value);
    bool same = true;
    for (size_t i = 0; i < switches->branch_count; i++) {
      double *mode = &instance->parameter[switches->branches[i].mode], sign = sign_with_error_bound(value[i], 0.0);
      same &= *mode == sign;
      *mode = sign;
    }
    if (same) return;
  }
}

void branches_guess(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool has_samples =
      switches->sample_count > 0 && lagrangian.prepare(instance->parameter, instance->parameter_constants) == 0;
  if (has_samples) switches->time_laws->start(instance);
  for (size_t i = 0; i < switches->contact_count; i++) instance->parameter[switches->contacts[i].mode] = 0.0;
  for (size_t i = 0; i < switches->friction_count; i++)
    instance->parameter[switches->frictions[i].mode] = instance->parameter[switches->frictions[i].reported] = 1.0;
  for (size_t i = 0; i < switches->resting_count; i++) instance->parameter[switches->resting[i].mode] = VELOCITY_MOVES;
  guess_branches(instance);
  if (switches->plane_count > 0) switches->friction_laws->guess(instance);
}
