#include "events/exchange.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "events/indicators.h"
#include "events/settlement.h"

enum { APPROACH_LIMIT = 20 };

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
