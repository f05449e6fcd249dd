#include "events/branches.h"

#include <math.h>

#include "evaluation/evaluate.h"
#include "events/continuity.h"
#include "events/indicators.h"
#include "instance/held.h"
#include "instance/time_laws.h"

/* Switches of one branch in an event resolution before it counts as endless. */
enum { FLIP_LIMIT = 8 };

static const char without_end[] = "a mode switches without end (chattering)";

static const char jammed[] = "a friction and a constraint jam each other";

/* In s: an importer that is back at a zero sooner makes no progress. */
static const double soonest_return = 1e-6;

static double sign_with_noise(double value, double noise) {
  return value > noise ? 1.0 : value < -noise ? -1.0 : 0.0;
}

/* True if the indicator is the velocity of a friction with prescribed motion, which moved when the event began. */
static bool is_driven(const struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  bool is_driven = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    is_driven |= switches->frictions[i].is_given && switches->frictions[i].mode == switches->branches[branch].mode &&
                 settlement->began[i] != 0.0;
  return is_driven;
}

/*
 * Returns the rounding error bound of a branch. At a located zero it includes the floor of the search. It also does for
 * a prescribed motion that has come to rest, whose velocity has the rounding error of its path.
 */
static double noise_of_branch(const struct Settlement *settlement, size_t branch) {
  double noise = settlement_noise(settlement, branch, branch_rate_place(settlement->switches, branch));
  bool is_rough = is_hit(settlement, branch) || is_driven(settlement, branch);
  return noise * (is_rough ? FLOOR_IN_NOISE : 1.0);
}

/* True if an event has left it a little beyond 0, and its rate leads back to the sign of its mode. */
static bool comes_back(const struct Settlement *settlement, size_t branch, double mode, double noise) {
  size_t rate = branch_rate_place(settlement->switches, branch);
  double value = settlement->value[branch];
  return mode * sign_with_noise(value, noise) < 0.0 && fabs(value) <= FLOOR_IN_NOISE * noise &&
         mode * settlement->value[rate] > settlement->noise[rate];
}

/* True if a branch at a located zero crosses it. The sign of an event's expression stays after other changes. */
static bool passes(const struct Settlement *settlement, size_t branch) {
  bool rests = settlement->switches->branches[branch].is_side && settlement->changed;
  return is_hit(settlement, branch) && settlement->flips[branch] == 0.0 && !settlement->jumped && !rests;
}

/*
 * True if an indicator at 0 without a rate stays there: a friction has begun to stick in this event, or a prescribed
 * motion has come to rest.
 */
static bool stays_at_zero(const struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  bool rests = is_driven(settlement, branch);
  for (size_t i = 0; i < switches->friction_count && !switches->branches[branch].is_side; i++)
    rests |= settlement->began[i] != 0.0 && friction_holds(settlement->instance, i);
  return rests;
}

/* Returns the next sign of an indicator: its own, or at 0 that of its rate. */
static double branch_mode(const struct Settlement *settlement, size_t branch) {
  size_t rate = branch_rate_place(settlement->switches, branch);
  double mode = mode_of(settlement, settlement->switches->branches[branch].mode);
  double noise = noise_of_branch(settlement, branch);
  if (comes_back(settlement, branch, mode, noise)) return mode;
  double sign = sign_with_noise(settlement->value[branch], noise);
  if (sign != 0.0) return sign;
  /* After a jump, even the smallest rate counts: it is not left by rounding. */
  sign = sign_with_noise(settlement->value[rate], settlement->jumped ? 0.0 : settlement->noise[rate]);
  if (sign != 0.0) return sign;
  if (passes(settlement, branch)) return mode == 0.0 ? settlement->instance->departure : -mode;
  /* Values that were set to 0, without a rate, are at rest, whatever their sign was. */
  bool was_set = settlement->jumped || settlement->occasion != AT_EVENT;
  return was_set || stays_at_zero(settlement, branch) ? 0.0 : mode;
}

/* Logs a branch both of whose signs lead back to its zero; returns the reason. */
static const char *refuse_branch(struct Settlement *settlement, size_t branch) {
  const struct FrictionLaws *laws = settlement->switches->friction_laws;
  const struct BranchFacts *facts = &settlement->switches->branches[branch];
  if (laws != NULL && laws->explain_jam(settlement, branch)) return jammed;
  if (continuity_explain_corner(settlement, branch)) return without_end;
  const char *remedy = lagrangian.coordinate_count > 0
                           ? "as with dry friction that sticks; expected <friction> in place of sign, or of a <state>"
                           : "as with a relay without hysteresis; expected";
  log_message(
      settlement->instance, settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
      "time %g: %s, line %ld of %s, chatters: on both sides of its jump the motion leads back to it, %s a <mode> "
      "that two events set at different values",
      settlement->time, facts->function, facts->line, facts->file, remedy);
  return without_end;
}

const char *branches_switch(struct Settlement *settlement, bool sides, bool *switched) {
  const struct SwitchTable *switches = settlement->switches;
  *switched = false;
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (switches->branches[i].is_side != sides) continue;
    double mode = branch_mode(settlement, i);
    if (mode == mode_of(settlement, switches->branches[i].mode)) continue;
    if (++settlement->flips[i] > FLIP_LIMIT) {
      const struct FrictionLaws *laws = switches->friction_laws;
      *switched = laws != NULL && laws->resolve_jam(settlement);
      return *switched ? NULL : settlement->has_several_motions ? jammed : refuse_branch(settlement, i);
    }
    continuity_note(settlement, i);
    settlement->rate[i] = settlement->value[branch_rate_place(switches, i)];
    settlement_set_mode(settlement, switches->branches[i].mode, mode);
    *switched = true;
  }
  return NULL;
}

const char *branches_check(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  if (settlement->occasion != IN_EXCHANGE || settlement->jumped || settlement->set_mode) return NULL;
  for (size_t i = 0; i < switches->branch_count; i++) {
    size_t place = branch_rate_place(switches, i);
    double mode = mode_of(settlement, switches->branches[i].mode), noise = settlement->noise[place];
    double rate = settlement->value[place];
    bool leads_back = mode * settlement->rate[i] > noise && mode * rate < -noise;
    if (leads_back && fabs(settlement->value[i]) <= soonest_return * fabs(rate)) return refuse_branch(settlement, i);
  }
  return NULL;
}

/*
 * Returns the sign of a branch at the start. At a kink of a gap, the rate gives the piece, which impacts need. An
 * event's expression at 0 has no sign yet.
 */
static double sign_at_start(const struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  size_t rate = branch_rate_place(switches, branch);
  double sign = sign_with_noise(settlement->value[branch], settlement_noise(settlement, branch, rate));
  if (sign != 0.0 || switches->branches[branch].is_side || switches->contact_laws == NULL) return sign;
  return sign_with_noise(settlement->value[rate], settlement->noise[rate]);
}

bool branches_begin(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t round = 0; round <= switches->branch_count; round++) {
    if (!settlement_evaluate(settlement)) return false;
    for (size_t i = 0; i < switches->branch_count; i++)
      settlement_set_mode(settlement, switches->branches[i].mode, sign_at_start(settlement, i));
  }
  return true;
}

static void guess_branches(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Point point = instance_point(instance);
  double *value = settlement_of(instance).value;
  /* With a mode of 0, a mass could be 0. */
  for (size_t i = 0; i < switches->branch_count; i++)
    if (instance->parameter[switches->branches[i].mode] == 0.0) instance->parameter[switches->branches[i].mode] = 1.0;
  for (size_t round = 0; round <= switches->branch_count; round++) {
    if (lagrangian.prepare(instance->parameter, instance->prepared) != 0) return;
    if (switches->feels_forces && lagrangian.constraints.accelerations(&point, instance->acceleration) != 0) return;
    switches->indicators(&point, instance->acceleration, value);
    bool same = true;
    for (size_t i = 0; i < switches->branch_count; i++) {
      double *mode = &instance->parameter[switches->branches[i].mode], sign = sign_with_noise(value[i], 0.0);
      same &= *mode == sign;
      *mode = sign;
    }
    if (same) return;
  }
}

void branches_guess(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool has_samples = switches->sample_count > 0 && lagrangian.prepare(instance->parameter, instance->prepared) == 0;
  if (has_samples) switches->time_laws->start(instance);
  for (size_t i = 0; i < switches->contact_count; i++) instance->parameter[switches->contacts[i].mode] = 0.0;
  for (size_t i = 0; i < switches->friction_count; i++)
    instance->parameter[switches->frictions[i].mode] = instance->parameter[switches->frictions[i].told] = 1.0;
  guess_branches(instance);
  if (switches->plane_count > 0) switches->friction_laws->guess(instance);
}
