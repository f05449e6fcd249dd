/*
 * The modes behind an event. Rounds of the following go on until one changes nothing: contacts; branches of pieces; frictions
 * that stick or slip; the sides of the expressions of events; and these events, each of which happens when its condition comes
 * to hold.
 */
#include "events/switching_parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "events/settlement.h"

enum { ROUND_LIMIT = 2000, FLIP_LIMIT = 8 };

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
  /* Where a piece ends or a friction sticks as it comes to 0, a side stays: it rests there. */
  bool rests = settlement->switches->branches[branch].is_side && settlement->changed;
  bool passes = is_hit(settlement, branch) && settlement->flips[branch] == 0.0 && !settlement->jumped && !rests;
  if (passes) return mode == 0.0 ? settlement->instance->departure : -mode;
  /* What was set to rest at 0 is there, wherever it comes from. */
  bool was_set = settlement->jumped || settlement->occasion != AT_EVENT;
  return was_set ? 0.0 : mode;
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

/* Those of pieces, or the sides. */
static const char *switch_branches(struct Settlement *settlement, bool sides, bool *switched) {
  const struct SwitchTable *switches = settlement->switches;
  *switched = false;
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (switches->branches[i].is_side != sides) continue;
    double mode = branch_mode(settlement, i);
    if (mode == mode_of(settlement, switches->branches[i].mode)) continue;
    if (++settlement->flips[i] > FLIP_LIMIT) return refuse_branch(settlement, i);
    continuity_note(settlement, i);
    settlement_set_mode(settlement, switches->branches[i].mode, mode);
    *switched = true;
  }
  return NULL;
}

static void assign(struct Settlement *settlement, const struct EventFacts *event) {
  const struct SwitchTable *switches = settlement->switches;
  const double *value = settlement->value + condition_place(settlement) + switches->event_count;
  for (size_t i = event->first_assignment; i < event->first_assignment + event->assignment_count; i++) {
    const struct AssignmentFacts *facts = &switches->assignments[i];
    if (facts->kind == VARIABLE_MODE) {
      settlement_set_mode(settlement, facts->index, value[i]);
      settlement->set_mode = true;
    } else {
      settlement->state[facts->index] = value[i];
      settlement->jumped = settlement->thrown = settlement->changed = true;
      settlement->moved |= facts->index < lagrangian.coordinate_count;
    }
  }
}

/*
 * Conditions as they are before events, all of them or those of contacts alone. Of an expression it is the side of 0 on which it
 * was last.
 */
static void note_conditions(struct Settlement *settlement, bool all) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double condition = settlement->value[condition_place(settlement) + i];
    bool stays = event->passage != PASSAGE_HOLDS && condition == 0.0;
    if (!stays && (all || event->is_of_contacts)) settlement->condition[i] = condition;
  }
}

/* Conditions and sides from which the settlement sets out. */
static void begin_events(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double condition = settlement->value[condition_place(settlement) + i];
    bool was_at_side = event->passage != PASSAGE_HOLDS && mode_of(settlement, event->side) != 0.0;
    settlement->condition[i] = was_at_side ? mode_of(settlement, event->side) : condition;
  }
}

/* An event may have turned an expression round before it came to the other side: that keeps its side. */
static void keep_sides(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct EventFacts *event = &switches->events[i];
    double sign = settlement->value[condition_place(settlement) + i];
    if (event->passage != PASSAGE_HOLDS && sign != 0.0) settlement->instance->parameter[event->side] = sign;
  }
}

/* An expression that has only been at 0 passes nothing. */
static bool happens(const struct Settlement *settlement, size_t event) {
  const struct EventFacts *facts = &settlement->switches->events[event];
  double condition = settlement->value[condition_place(settlement) + event], before = settlement->condition[event];
  if (facts->passage == PASSAGE_HOLDS) return condition > 0.0 && !(before > 0.0);
  bool rises = condition > 0.0 && before < 0.0, falls = condition < 0.0 && before > 0.0;
  return (rises && facts->passage != PASSAGE_FALLS) || (falls && facts->passage != PASSAGE_RISES);
}

/* Whether two events set the same. */
static bool are_rivals(const struct SwitchTable *switches, const struct EventFacts *one,
                       const struct EventFacts *other) {
  for (size_t i = one->first_assignment; i < one->first_assignment + one->assignment_count; i++)
    for (size_t j = other->first_assignment; j < other->first_assignment + other->assignment_count; j++) {
      const struct AssignmentFacts *first = &switches->assignments[i], *second = &switches->assignments[j];
      if (first->kind == second->kind && first->index == second->index) return true;
    }
  return false;
}

/* Logs two events that happen at once and set the same. Whether there are any. */
static bool find_rivals(const struct Settlement *settlement, size_t event) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t k = 0; k < event; k++) {
    if (!happens(settlement, k)) continue;
    if (!are_rivals(switches, &switches->events[k], &switches->events[event])) continue;
    log_message(
        settlement->instance, settlement->occasion == AT_START ? STATUS_ERROR : STATUS_DISCARD,
        "time %g: the events of when=\"%s\" and when=\"%s\" happen at once and set the same; expected one event, or "
        "conditions that keep them apart",
        settlement->time, switches->events[k].when, switches->events[event].when);
    return true;
  }
  return false;
}

/* Events whose condition has come to hold, all with the values before them; *again where there are any. */
static const char *happen(struct Settlement *settlement, bool *again) {
  const struct SwitchTable *switches = settlement->switches;
  *again = false;
  /* What contacts and frictions come to at the start has held before. */
  if (settlement->occasion == AT_START && !settlement->has_started) note_conditions(settlement, false);
  settlement->has_started = true;
  for (size_t i = 0; i < switches->event_count; i++) {
    if (!happens(settlement, i)) continue;
    if (find_rivals(settlement, i)) return "two events contradict each other";
    assign(settlement, &switches->events[i]);
    *again = true;
  }
  note_conditions(settlement, true);
  if (!*again) keep_sides(settlement);
  return NULL;
}

static bool has_sides(const struct SwitchTable *switches) {
  bool has = false;
  for (size_t i = 0; i < switches->branch_count; i++) has |= switches->branches[i].is_side;
  return has;
}

/* An importer comes to an event a little late: velocities that stick from it on are at rest before their side is asked for. */
static const char *settle_sides(struct Settlement *settlement, bool *again) {
  if (!has_sides(settlement->switches)) return NULL;
  if (!settlement->lags) return switch_branches(settlement, true, again);
  settlement->lags = false;
  *again = true;
  return settlement_push(settlement) ? NULL : constraints_not_kept;
}

/* One round; *again where it changed something. */
static const char *settle_once(struct Settlement *settlement, bool *again) {
  const char *problem = NULL;
  *again = false;
  if (settlement->switches->contact_laws != NULL) problem = settlement->switches->contact_laws->act(settlement, again);
  if (problem != NULL || *again) return problem;
  problem = switch_branches(settlement, false, again);
  if (problem != NULL || *again) return problem;
  if (settlement->switches->friction_laws != NULL)
    problem = settlement->switches->friction_laws->act(settlement, again);
  settlement->lags |= *again && settlement->occasion != AT_START;
  if (problem != NULL || *again) return problem;
  if (settlement->switches->contact_laws != NULL)
    problem = settlement->switches->contact_laws->settle_forces(settlement, again);
  if (problem != NULL || *again) return problem;
  if (settlement->switches->friction_laws != NULL && !settlement->switches->friction_laws->tell(settlement, again))
    return "there are no accelerations at an event";
  if (!*again) problem = settle_sides(settlement, again);
  return problem != NULL || *again ? problem : happen(settlement, again);
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
  if (switches->contact_laws != NULL && (settlement->moved || may_turn_gaps(settlement)))
    problem = switches->contact_laws->check_gaps(settlement);
  if (problem == NULL && switches->friction_laws != NULL) problem = switches->friction_laws->check(settlement);
  return problem;
}

static const char *settle(struct Instance *instance, double time, double *state, enum Occasion occasion,
                          size_t indicator, bool *changed) {
  struct Settlement settlement = settlement_at(instance, time, state, occasion);
  settlement.indicator = indicator;
  const char *problem = occasion == AT_START ? begin_modes(&settlement) : continuity_begin(&settlement);
  bool again = true;
  for (int round = 0; problem == NULL && again; round++) {
    if (round == ROUND_LIMIT) problem = "events follow one another there without end";
    else if (!settlement_evaluate(&settlement)) problem = "there are no accelerations at an event";
    if (round == 0 && problem == NULL) begin_events(&settlement);
    if (problem == NULL) problem = settle_once(&settlement, &again);
  }
  if (problem == NULL && settlement.jumped && lagrangian.projection != NULL && !settlement_push(&settlement))
    problem = constraints_not_kept;
  if (problem == NULL) problem = continuity_check(&settlement);
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
  struct Point point = instance_point(instance);
  double *value = settlement_of(instance).value;
  for (size_t i = 0; i < switches->contact_count; i++) instance->parameter[switches->contacts[i].mode] = 0.0;
  for (size_t i = 0; i < switches->friction_count; i++)
    instance->parameter[switches->frictions[i].mode] = instance->parameter[switches->frictions[i].told] = 1.0;
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

/* Those that have no value beyond the end of a piece have that of its end. */
static void complete_indicators(struct Instance *instance, double *value) {
  size_t count = indicator_count(lagrangian.switches);
  double *completed = instance->switching_work + count; /* the first so many may be the values */
  struct Point point = instance_point(instance);
  bool lacks = false;
  for (size_t i = 0; i < count; i++) lacks |= isnan(value[i]);
  if (!lacks || !switching_come_back(instance, &point)) return;
  if (!switching_indicators(instance, point.time, point.state, completed)) return;
  for (size_t i = 0; i < count; i++)
    if (isnan(value[i])) value[i] = completed[i];
}

/*
 * What an importer is told keeps its sign until the indicator is a little beyond 0, so that it is not 0 behind an event
 * (FMI 2.0, section 3.2.2; FMI 3.0, section 3.2.1). That of a branch at rest at 0 leaves it on either side.
 */
static bool told_indicators(struct Instance *instance, double *value) {
  static const double shift = 1e-11;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  if (!switching_indicators(instance, instance->situation->time, instance->state, value)) return false;
  complete_indicators(instance, value);
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++) {
    double sign = switching_sign(instance, i);
    value[i] = sign == 0.0 ? shift - fabs(value[i]) : value[i] + sign * shift;
  }
  return true;
}

static bool is_due(struct Instance *instance) {
  double *value = instance->switching_work;
  if (!told_indicators(instance, value)) return false;
  bool due = false;
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++)
    due |= (switching_sign(instance, i) < 0.0 ? -value[i] : value[i]) < 0.0;
  return due;
}

static bool holds_at_times(const char *constraint) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_held = false;
  for (size_t i = 0; i < switches->contact_count; i++) is_held |= strcmp(switches->contacts[i].name, constraint) == 0;
  for (size_t i = 0; i < switches->friction_count; i++) is_held |= strcmp(switches->frictions[i].name, constraint) == 0;
  return is_held;
}

const struct Switching switching = {.work_count = settlement_work_count,
                                    .settle = settle,
                                    .guess = guess,
                                    .start = switching_start,
                                    .release = switching_release,
                                    .resume = switching_resume,
                                    .update = switching_update,
                                    .pass = switching_pass,
                                    .pass_barrier = switching_pass_barrier,
                                    .explain = switching_explain,
                                    .holds_at_times = holds_at_times,
                                    .check = switching_check,
                                    .come_back = switching_come_back,
                                    .indicators = told_indicators,
                                    .is_due = is_due};
