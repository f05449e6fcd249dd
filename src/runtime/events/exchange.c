#include "events/exchange.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "events/indicators.h"
#include "events/settle.h"
#include "events/settlement.h"
#include "instance/projection.h"

enum { APPROACH_LIMIT = 20 };

/* Expressions of events that an importer has passed at once, one after another. */
enum { LATE_LIMIT = 8 };

/* A little further than to the zero itself, where rounding may leave a state beyond it. */
static const double surplus = 64.0 * DBL_EPSILON;

/* How long before the motion was at the end of the piece that it has left furthest; 0 for none, NAN where it is unknown. */
static double time_beyond(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  double time = 0.0;
  for (size_t i = 0; i < switches->branch_count; i++) {
    double sign = mode_of(settlement, switches->branches[i].mode),
           rate = settlement->value[branch_rate_place(switches, i)];
    if (!(sign * settlement->value[i] < 0.0)) continue;
    if (!(sign * rate < 0.0)) return NAN;
    time = fmax(time, settlement->value[i] / rate);
  }
  return time;
}

bool exchange_come_back(struct Instance *instance, struct Point *point) {
  struct Settlement settlement = settlement_of(instance);
  size_t n = lagrangian.coordinate_count;
  double *state = settlement.rounded;
  memcpy(state, point->state, lagrangian.state_count * sizeof *state);
  point->state = state;
  /* There are none here, and none are needed where places and times end the pieces. */
  memset(settlement.acceleration, 0, (n + lagrangian.constraints.count) * sizeof *settlement.acceleration);
  for (int i = 0; i < APPROACH_LIMIT; i++) {
    settlement.switches->switching_values(point, settlement.acceleration, settlement.value);
    double back = time_beyond(&settlement);
    if (!(back > 0.0)) return i > 0 && back == 0.0;
    back += surplus * fmax(back, fabs(point->time));
    for (size_t k = 0; k < n; k++) state[k] -= back * state[n + k];
    point->time -= back;
  }
  return false;
}

/* Those that have no value beyond the end of a piece have that of its end. */
static void complete_indicators(struct Instance *instance, double *value) {
  size_t count = indicator_count(lagrangian.switches);
  double *completed = instance->switching_work + count; /* the first so many may be the values */
  struct Point point = instance_point(instance);
  bool lacks = false;
  for (size_t i = 0; i < count; i++) lacks |= isnan(value[i]);
  if (!lacks || !exchange_come_back(instance, &point)) return;
  if (!indicators_at(instance, point.time, point.state, completed)) return;
  for (size_t i = 0; i < count; i++)
    if (isnan(value[i])) value[i] = completed[i];
}

/* How far beyond 0 an importer is told of a zero: at most, and in units of what rounding makes of the indicator. */
static const double largest_shift = 1e-11, shift_in_noise = 1e5;

/* Of an indicator that rounding the state changes by noise, its own operations by rounding; of neither, the largest. */
static double shift_of(double noise, double rounding) {
  double shift = fmax(shift_in_noise * noise, FLOOR_IN_NOISE * rounding);
  return shift > 0.0 && shift < largest_shift ? shift : largest_shift;
}

/* shift[i] of each indicator, with workspace. Small ones, as of a gap in large units, are shifted by less. */
static void find_shifts(struct Instance *instance, const double *value, double *shift) {
  size_t count = indicator_count(lagrangian.switches);
  double *rounding = shift + count, *rounded = rounding + count;
  double time = instance->situation->time;
  indicator_roundings(instance, time, instance->state, instance->acceleration, rounding);
  bool known = indicator_noise(instance, time, instance->state, true, value, rounded, shift);
  for (size_t i = 0; i < count; i++)
    shift[i] = known && !indicator_is_force(instance, i) ? shift_of(shift[i], rounding[i]) : largest_shift;
}

/*
 * What an importer is told keeps its sign until the indicator is a little beyond 0, so that it is not 0 behind an event
 * (FMI 2.0, section 3.2.2; FMI 3.0, section 3.2.1). That of a branch at rest at 0 leaves it on either side.
 */
bool exchange_indicators(struct Instance *instance, double *value) {
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  if (!indicators_at(instance, instance->situation->time, instance->state, value)) return false;
  size_t count = indicator_count(lagrangian.switches);
  double *shift = instance->switching_work + count; /* the first so many may be the values */
  complete_indicators(instance, value);
  find_shifts(instance, value, shift);
  for (size_t i = 0; i < count; i++) {
    double sign = indicator_sign(instance, i);
    value[i] = sign == 0.0 ? shift[i] - fabs(value[i]) : value[i] + sign * shift[i];
  }
  return true;
}

bool exchange_is_due(struct Instance *instance) {
  double *value = instance->switching_work;
  if (!exchange_indicators(instance, value)) return false;
  bool due = false;
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++)
    due |= (indicator_sign(instance, i) < 0.0 ? -value[i] : value[i]) < 0.0;
  return due;
}

/*
 * Events that look both ways. An importer is beyond the zero of their expression when it asks, and what turns the motion back there
 * would pass the zero again on the way back. The motion is taken back to the zero by its Taylor polynomial of second order, goes
 * through the event as in co-simulation, and forward again for the same time. Both errors are of third order in the lateness.
 */

/* Whether an event looks both ways, and the importer came to the present state by integration. */
static bool may_turn_back(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool looks_both_ways = false;
  for (size_t i = 0; i < switches->event_count; i++) looks_both_ways |= switches->events[i].passage == PASSAGE_BOTH;
  return looks_both_ways && switches->has_sides && instance->situation->changed != CHANGED_VALUES;
}

/* In s: how long ago an expression was 0 that has left its side; 0 for none. */
static double lateness_of(const struct Settlement *settlement, size_t branch) {
  const struct BranchFacts *facts = &settlement->switches->branches[branch];
  double side = mode_of(settlement, facts->mode), value = settlement->value[branch];
  double rate = settlement->value[branch_rate_place(settlement->switches, branch)];
  return facts->is_side && side * value < 0.0 && side * rate < 0.0 ? value / rate : 0.0;
}

/* The expression that was passed first; branch_count for none. */
static size_t find_late_branch(const struct Settlement *settlement) {
  size_t passed = settlement->switches->branch_count;
  double longest = 0.0;
  for (size_t i = 0; i < settlement->switches->branch_count; i++) {
    double lateness = lateness_of(settlement, i);
    if (!(lateness > longest)) continue;
    longest = lateness;
    passed = i;
  }
  return passed;
}

/* Moves the state by a time, with the accelerations that were evaluated last. */
static void move_by(struct Settlement *settlement, double duration) {
  const double *acceleration = settlement_accelerations(settlement);
  double *position = settlement->state, *velocity = position + lagrangian.coordinate_count;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    position[i] += duration * (velocity[i] + 0.5 * duration * acceleration[i]);
    velocity[i] += duration * acceleration[i];
  }
  settlement->time += duration;
}

/* Moves the state back to the zero of a branch. False where that is not found. */
static bool go_to_zero(struct Settlement *settlement, size_t branch) {
  for (int i = 0; i < APPROACH_LIMIT; i++) {
    double rate = settlement->value[branch_rate_place(settlement->switches, branch)];
    double duration = -settlement->value[branch] / rate;
    if (!isfinite(duration)) return false;
    if (fabs(duration) <= 4.0 * DBL_EPSILON * fabs(settlement->time) || settlement->value[branch] == 0.0) return true;
    move_by(settlement, duration);
    if (!settlement_values(settlement, settlement->state, settlement->value)) return false;
  }
  return false;
}

/* Goes through the event at the first zero that was passed. *passes where there was one. NULL, or the reason why it cannot. */
static const char *pass_late(struct Instance *instance, bool *passes, bool *changed) {
  double time = instance->situation->time, *state = instance->event_state, *before = state + lagrangian.state_count;
  size_t size = lagrangian.state_count * sizeof *state;
  *passes = false;
  memcpy(state, instance->state, size);
  struct Settlement settlement = settlement_at(instance, time, state, IN_EXCHANGE);
  if (evaluate_prepare(instance) != STATUS_DONE || !settlement_values(&settlement, state, settlement.value))
    return NULL;
  size_t branch = find_late_branch(&settlement);
  if (branch == lagrangian.switches->branch_count || !go_to_zero(&settlement, branch)) return NULL;
  double zero = settlement.time;
  memcpy(before, state, size);
  const char *problem = settle(instance, zero, state, AT_EVENT, branch, passes);
  *changed |= *passes;
  if (problem != NULL || memcmp(before, state, size) == 0) return problem;
  settlement = settlement_at(instance, zero, state, IN_EXCHANGE);
  if (evaluate_prepare(instance) != STATUS_DONE || !settlement_values(&settlement, state, settlement.value))
    return "there are no accelerations behind an event";
  move_by(&settlement, time - zero);
  memcpy(instance->state, state, size);
  return NULL;
}

/* What an importer sets in event mode may jump. */
static void release_frictions(struct Instance *instance) {
  const struct FrictionLaws *laws = lagrangian.switches->friction_laws;
  if (laws == NULL || instance->situation->changed != CHANGED_VALUES) return;
  struct Settlement settlement = settlement_at(instance, instance->situation->time, instance->state, IN_EXCHANGE);
  if (settlement_evaluate(&settlement)) laws->release(&settlement);
}

/* What an integrator may leave of the constraints, in units of the scales of the state; a state further away was set. */
static const double largest_deviation = 1e-3;

/*
 * Takes the state onto the constraints of the present modes before these are judged: what an integrator leaves of them is no
 * motion, and a closed contact would take a rate of -1e-6 m/s of its gap for an impact. So small a change of a parameter is followed, too.
 */
static void return_to_constraints(struct Instance *instance, bool *changed) {
  double *state = instance->event_state;
  size_t size = lagrangian.state_count * sizeof *state;
  if (lagrangian.constraints.projection == NULL || evaluate_prepare(instance) != STATUS_DONE) return;
  memcpy(state, instance->state, size);
  double moved = lagrangian.constraints.projection->project(instance, instance->situation->time, state);
  if (!(moved > 0.0 && moved <= largest_deviation)) return;
  memcpy(instance->state, state, size);
  *changed = true;
}

const char *exchange_settle(struct Instance *instance, bool *changed) {
  const char *problem = NULL;
  bool passes = may_turn_back(instance), others;
  *changed = false;
  return_to_constraints(instance, changed);
  for (int i = 0; i < LATE_LIMIT && passes && problem == NULL; i++) problem = pass_late(instance, &passes, changed);
  if (problem != NULL) return problem;
  release_frictions(instance);
  problem = settle(instance, instance->situation->time, instance->state, IN_EXCHANGE, 0, &others);
  *changed |= others;
  return problem;
}
