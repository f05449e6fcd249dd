/*
 * The modes behind an event. Rounds of the following go on until one changes nothing: contacts; frictions that stick or slip;
 * branches; and the events of the system, each of which happens when its condition comes to hold.
 */
#include "switching_parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluate.h"
#include "projection.h"
#include "settlement.h"
#include "solver.h"

enum { ROUND_LIMIT = 2000, FLIP_LIMIT = 8 };

/* In units of the scales of the state: less of a change may be rounding. */
static const double least_kink = 1e-6;

static const char not_kept[] = "the constraints cannot be kept at an event";

/* Whether indicators are forces: some constraint of a contact or friction holds, or branches turn by one. */
static bool feels_forces(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool holds = switches->feels_forces;
  for (size_t i = 0; i < switches->contact_count; i++) holds |= instance->parameter[switches->contacts[i].mode] > 0.0;
  for (size_t i = 0; i < switches->friction_count; i++)
    holds |= instance->parameter[switches->frictions[i].mode] == 0.0;
  return holds;
}

bool switching_indicators(struct Instance *instance, double time, const double *state, double *indicator) {
  struct Point point = solver_point(instance, time, state);
  if (feels_forces(instance)) {
    instance->singular = lagrangian.accelerations(&point, instance->acceleration);
    if (instance->singular != 0) return false;
  }
  lagrangian.switches->indicators(&point, instance->acceleration, indicator);
  return true;
}

double switching_sign(const struct Instance *instance, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  return indicator < switches->branch_count ? instance->parameter[switches->branches[indicator].mode] : 1.0;
}

/* --- The rounds --- */

static double sign_with_noise(double value, double noise) {
  return value > noise ? 1.0 : value < -noise ? -1.0 : 0.0;
}

/* The sign that an indicator has next: of itself, or, where it is 0, of its rate. */
static double branch_mode(const struct Settlement *settlement, size_t branch) {
  size_t rate = settlement->switches->branch_count + branch;
  double mode = mode_of(settlement, settlement->switches->branches[branch].mode);
  /* Where its zero was located, it may be left as far below as event_search.c takes for rounding. */
  double noise = settlement_noise(settlement, branch, rate) * (is_hit(settlement, branch) ? FLOOR_IN_NOISE : 1.0);
  double sign = sign_with_noise(settlement->value[branch], noise);
  bool comes_back = mode * sign < 0.0 && fabs(settlement->value[branch]) <= FLOOR_IN_NOISE * noise &&
                    mode * settlement->value[rate] > settlement->noise[rate];
  if (comes_back) return mode; /* from what an event has left of it */
  if (sign != 0.0) return sign;
  /* What an event has set is not what rounding has left, however small. */
  sign = sign_with_noise(settlement->value[rate], settlement->jumped ? 0.0 : settlement->noise[rate]);
  if (sign != 0.0) return sign;
  bool passes = is_hit(settlement, branch) && settlement->flips[branch] == 0.0 && !settlement->jumped;
  if (!passes) return mode;
  return mode == 0.0 ? settlement->instance->departure : -mode;
}

static const char without_end[] = "a mode changes to and fro there without end";

/* Where neither side of a zero leads away from it. */
static const char *refuse_branch(const struct Settlement *settlement, size_t branch) {
  const struct BranchFacts *facts = &settlement->switches->branches[branch];
  log_message(
      settlement->instance, STATUS_DISCARD,
      "time %g: %s, line %ld of system.xml, jumps to and fro there: on either side of its jump the motion leads "
      "back to it, as with dry friction that sticks; expected <friction>, which sticks, in place of sign",
      settlement->time, facts->function, facts->line);
  return without_end;
}

/*
 * A branch that switches must not move a constraint: positions and velocities would have to jump. What the solver has left
 * of the constraints is taken up before.
 */
static const char *take_up_drift(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool can_matter = switches->branch_count > 0 || switches->assignment_count > 0;
  if (lagrangian.projection == NULL || !can_matter || settlement->occasion == AT_START) return NULL;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return not_kept;
  double moved = lagrangian.projection->project(settlement->instance, settlement->time, settlement->state);
  return isfinite(moved) ? NULL : not_kept;
}

static void note_switch(struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  double rate = settlement->value[switches->branch_count + branch];
  if (settlement->switched != NULL) return;
  settlement->switched = &switches->branches[branch];
  settlement->overshoot = rate != 0.0 ? fabs(settlement->value[branch] / rate) : 0.0;
}

static void note_energy(struct Settlement *settlement, const struct BranchFacts *facts) {
  if (!facts->holds_energy || settlement->energetic != NULL) return;
  settlement->energetic = facts;
  memcpy(settlement->energy, settlement->value + energy_place(settlement),
         settlement->switches->energy_count * sizeof(double));
}

/* How far a branch without a kink may move the state, in units of its scales: an importer comes to it late. */
static double largest_move(const struct Settlement *settlement) {
  double change = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    size_t velocity = lagrangian.coordinate_count + i;
    double scale = fmax(fabs(settlement->state[velocity]), lagrangian.nominal[velocity]);
    change = fmax(change, fabs(settlement->acceleration[i]) / scale);
  }
  return least_kink + 4.0 * settlement->overshoot * change;
}

/* The largest jump among so many energies or momenta, of those from first on, as a share of their size. */
static double largest_jump(const struct Settlement *settlement, size_t first, size_t count) {
  const double *before = settlement->energy + first, *behind = settlement->value + energy_place(settlement) + first;
  const double *noise = settlement->noise + energy_place(settlement) + first;
  double size = 0.0, jump = 0.0;
  for (size_t i = 0; i < count; i++) size = fmax(size, fmax(fabs(before[i]), fabs(behind[i])));
  for (size_t i = 0; i < count; i++)
    if (fabs(behind[i] - before[i]) > 8.0 * noise[i]) jump = fmax(jump, fabs(behind[i] - before[i]) / size);
  return jump;
}

/*
 * Where an energy or a momentum jumps as the motion comes to a place, the velocities would have to jump with it, by a law
 * that the system does not tell.
 */
static const char *check_energy(const struct Settlement *settlement) {
  bool by_events = settlement->jumped || settlement->set_mode || settlement->occasion == AT_CHANGE;
  if (settlement->energetic == NULL || by_events || settlement->occasion == AT_START) return NULL;
  size_t count = settlement->switches->energy_count;
  double jump = fmax(largest_jump(settlement, 0, 2), largest_jump(settlement, 2, count - 2));
  if (!(jump > largest_move(settlement))) return NULL;
  log_message(
      settlement->instance, settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
      "time %g: %s, line %ld of system.xml, jumps there in an energy or a position, by a share of %.2g, for which no "
      "velocity tells its part; expected energies without jumps, or an <event> that sets the velocities",
      settlement->time, settlement->energetic->function, settlement->energetic->line, jump);
  return "an energy jumps";
}

/* Whether the constraints hold as before in the branches that were switched to. */
static const char *check_constraints(struct Settlement *settlement) {
  struct Instance *instance = settlement->instance;
  bool may_turn = (settlement->switched != NULL || settlement->set_mode) && !settlement->jumped;
  if (lagrangian.projection == NULL || !(may_turn || settlement->moved)) return NULL;
  if (evaluate_prepare(instance) != STATUS_DONE) return not_kept;
  bool starts = settlement->occasion == AT_START;
  double moved = starts ? lagrangian.projection->drift(instance, settlement->time)
                        : lagrangian.projection->project(instance, settlement->time, settlement->state);
  if (moved <= largest_move(settlement)) return NULL;
  enum Status status = starts || settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD;
  if (settlement->set_mode || settlement->moved)
    log_message(instance, status,
                "time %g: an event sets %s so that the constraints do not hold; expected values of <set> for all "
                "coordinates and velocities that they move, which fulfil them",
                settlement->time, settlement->moved ? "coordinates" : "modes");
  else
    log_message(
        instance, status,
        "time %g: %s, line %ld of system.xml, turns or jumps there in a constraint, and positions or velocities "
        "would have to jump with it; expected a constraint without kinks, or a <contact>, which has impacts",
        settlement->time, settlement->switched->function, settlement->switched->line);
  return not_kept;
}

static const char *switch_branches(struct Settlement *settlement, bool *switched) {
  const struct SwitchTable *switches = settlement->switches;
  *switched = false;
  for (size_t i = 0; i < switches->branch_count; i++) {
    double mode = branch_mode(settlement, i);
    if (mode == mode_of(settlement, switches->branches[i].mode)) continue;
    if (++settlement->flips[i] > FLIP_LIMIT) return refuse_branch(settlement, i);
    note_switch(settlement, i);
    note_energy(settlement, &switches->branches[i]);
    settlement_set_mode(settlement, switches->branches[i].mode, mode);
    *switched = true;
  }
  return NULL;
}

static void assign(struct Settlement *settlement, const struct EventFacts *event) {
  const struct SwitchTable *switches = settlement->switches;
  const double *value = settlement->value + condition_place(settlement) + switches->condition_count;
  for (size_t i = event->first_assignment; i < event->first_assignment + event->assignment_count; i++) {
    const struct AssignmentFacts *facts = &switches->assignments[i];
    if (facts->kind == VARIABLE_MODE) {
      settlement_set_mode(settlement, facts->index, value[i]);
      settlement->set_mode = true;
    } else {
      settlement->state[facts->index] = value[i];
      settlement->jumped = settlement->changed = true;
      settlement->moved |= facts->index < lagrangian.coordinate_count;
    }
  }
}

/* Events whose condition has come to hold, all with the values before them. */
static bool happen(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  const double *condition = settlement->value + condition_place(settlement);
  bool any = false;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    bool happens = false;
    for (size_t k = event->first_condition; k < event->first_condition + event->condition_count; k++)
      happens |= condition[k] > 0.0 && !(settlement->condition[k] > 0.0);
    if (happens) assign(settlement, event);
    any |= happens;
  }
  memcpy(settlement->condition, condition, switches->condition_count * sizeof *condition);
  return any;
}

/* One round; *again where it changed something. */
static const char *settle_once(struct Settlement *settlement, bool *again) {
  const char *problem = NULL;
  *again = false;
  if (settlement->switches->contact_laws != NULL) problem = settlement->switches->contact_laws->act(settlement, again);
  if (problem != NULL || *again) return problem;
  problem = switch_branches(settlement, again);
  if (problem != NULL || *again) return problem;
  if (settlement->switches->friction_laws != NULL)
    problem = settlement->switches->friction_laws->act(settlement, again);
  if (problem != NULL || *again) return problem;
  *again = happen(settlement);
  return NULL;
}

static void copy_conditions(struct Settlement *settlement) {
  memcpy(settlement->condition, settlement->value + condition_place(settlement),
         settlement->switches->condition_count * sizeof *settlement->condition);
}

/* Modes as the signs of the start values say. */
static const char *begin_modes(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t round = 0; round <= switches->branch_count; round++) {
    if (!settlement_evaluate(settlement)) return "there are no accelerations";
    for (size_t i = 0; i < switches->branch_count; i++) {
      double noise = settlement_noise(settlement, i, switches->branch_count + i);
      settlement_set_mode(settlement, switches->branches[i].mode, sign_with_noise(settlement->value[i], noise));
    }
  }
  return switches->contact_laws != NULL ? switches->contact_laws->check_gaps(settlement) : NULL;
}

/* What must hold of contacts and frictions behind an event. */
static const char *check_laws(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  const char *problem = NULL;
  if (switches->contact_laws != NULL && settlement->moved) problem = switches->contact_laws->check_gaps(settlement);
  if (problem == NULL && switches->friction_laws != NULL) problem = switches->friction_laws->check(settlement);
  return problem;
}

static const char *settle(struct Instance *instance, double time, double *state, enum Occasion occasion,
                          size_t indicator, bool *changed) {
  struct Settlement settlement = settlement_of(instance);
  settlement.time = time;
  settlement.state = state;
  settlement.occasion = occasion;
  settlement.indicator = indicator;
  const char *problem = occasion == AT_START ? begin_modes(&settlement) : take_up_drift(&settlement);
  bool again = true;
  for (int round = 0; problem == NULL && again; round++) {
    if (round == ROUND_LIMIT) problem = "events follow one another there without end";
    else if (!settlement_evaluate(&settlement)) problem = "there are no accelerations at an event";
    if (round == 0 && problem == NULL) copy_conditions(&settlement);
    if (problem == NULL) problem = settle_once(&settlement, &again);
  }
  if (problem == NULL && settlement.jumped && lagrangian.projection != NULL && !settlement_push(&settlement, 1.0))
    problem = not_kept;
  if (problem == NULL) problem = check_energy(&settlement);
  if (problem == NULL) problem = check_constraints(&settlement);
  if (problem == NULL) problem = check_laws(&settlement);
  /* In exchange the event mode itself takes up what an importer went too far. */
  bool has_to_keep = lagrangian.projection != NULL && occasion != AT_START && occasion != IN_EXCHANGE;
  if (problem == NULL && settlement.changed && has_to_keep) problem = solver_project(instance, time, state);
  if (settlement.changed && occasion != AT_START) instance->situation->statistics[STATISTIC_EVENTS]++;
  *changed = settlement.changed;
  return problem;
}

/* Signs of the present values, without events: what a reader may expect before the simulation starts. */
static void guess(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Point point = evaluate_point(instance);
  double *value = settlement_of(instance).value;
  for (size_t i = 0; i < switches->contact_count; i++) instance->parameter[switches->contacts[i].mode] = 0.0;
  for (size_t i = 0; i < switches->friction_count; i++) instance->parameter[switches->frictions[i].mode] = 1.0;
  /* Of a mass that a sign decides on, 0 leaves nothing. */
  for (size_t i = 0; i < switches->branch_count; i++)
    if (instance->parameter[switches->branches[i].mode] == 0.0) instance->parameter[switches->branches[i].mode] = 1.0;
  for (size_t round = 0; round <= switches->branch_count; round++) {
    if (lagrangian.prepare(instance->parameter, instance->prepared) != 0) return;
    if (switches->feels_forces && lagrangian.accelerations(&point, instance->acceleration) != 0) return;
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

static bool situation_indicators(struct Instance *instance, double *value) {
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  return switching_indicators(instance, instance->situation->time, instance->state, value);
}

static bool is_due(struct Instance *instance) {
  size_t count = indicator_count(lagrangian.switches);
  double *value = instance->switching_work;
  if (!situation_indicators(instance, value)) return false;
  bool due = false;
  for (size_t i = 0; i < count; i++) {
    double sign = switching_sign(instance, i);
    due |= sign * value[i] < 0.0 || (sign == 0.0 && value[i] != 0.0);
  }
  return due;
}

const struct Switching switching = {.work_count = settlement_work_count,
                                    .settle = settle,
                                    .guess = guess,
                                    .start = switching_start,
                                    .resume = switching_resume,
                                    .update = switching_update,
                                    .pass = switching_pass,
                                    .pass_barrier = switching_pass_barrier,
                                    .explain = switching_explain,
                                    .indicators = situation_indicators,
                                    .is_due = is_due};
