#include "events/indicators.h"

#include <float.h>
#include <math.h>

#include "evaluation/services.h"

/* A state is not told from others nearer than the last digit of this share of its nominal value. */
static const double least_share = 0.1;

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

void switching_round(const double *state, bool otherwise, double *rounded) {
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double size = fmax(fabs(state[i]), least_share * lagrangian.nominal[i]);
    double change = (double)(1 + (otherwise ? i * 3 % 7 : i * 7 % 5)) * DBL_EPSILON * size;
    rounded[i] = state[i] + ((otherwise ? i / 2 : i) % 2 == 0 ? change : -change);
  }
}
