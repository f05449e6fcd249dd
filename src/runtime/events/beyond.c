/*
 * An importer tries states beyond the end of a piece, before it knows of the event there, and the piece may have no value,
 * as (-y)^1.5 where y > 0. It gets the value at that end.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "events/settlement.h"

enum { APPROACH_LIMIT = 20 };

/* A little further than to the zero itself, where rounding may leave a state beyond it. */
static const double surplus = 64.0 * DBL_EPSILON;

/* How long before the motion was at the end of the piece that it has left furthest; 0 for none, NAN where it is unknown. */
static double time_beyond(const struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  double time = 0.0;
  for (size_t i = 0; i < switches->branch_count; i++) {
    double sign = mode_of(settlement, switches->branches[i].mode), rate = settlement->value[switches->branch_count + i];
    if (!(sign * settlement->value[i] < 0.0)) continue;
    if (!(sign * rate < 0.0)) return NAN;
    time = fmax(time, settlement->value[i] / rate);
  }
  return time;
}

bool switching_come_back(struct Instance *instance, struct Point *point) {
  struct Settlement settlement = settlement_of(instance);
  size_t n = lagrangian.coordinate_count;
  double *state = settlement.rounded;
  memcpy(state, point->state, lagrangian.state_count * sizeof *state);
  point->state = state;
  /* There are none here, and none are needed where places and times end the pieces. */
  memset(settlement.acceleration, 0, (n + lagrangian.constraint_count) * sizeof *settlement.acceleration);
  for (int i = 0; i < APPROACH_LIMIT; i++) {
    settlement.switches->values(point, settlement.acceleration, settlement.value);
    double back = time_beyond(&settlement);
    if (!(back > 0.0)) return i > 0 && back == 0.0;
    back += surplus * fmax(back, fabs(point->time));
    for (size_t k = 0; k < n; k++) state[k] -= back * state[n + k];
    point->time -= back;
  }
  return false;
}
