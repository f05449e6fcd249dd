#include "detection/indicators.h"

#include <float.h>
#include <math.h>

#include "evaluation/services.h"
#include "instance/active_constraints.h"

/* The rounding error of a state is at least that of this fraction of its nominal value. */
static const double least_share = 0.1;

/* Ratio of a rounding error bound to the change by one perturbation. */
static const double error_bound_of_difference = 8.0;
/* Factor of the second pattern: a sum with larger terms may lose a change in the last digit, but not a larger one. */
static const double further = 8.0;

/* Relative rounding error of an operation or a library function. */
static const double rounding_of_operation = DBL_EPSILON;

/* The same for forces of constraints, relative to the largest one that acts with them. */
static const double rounding_of_force = 64.0 * DBL_EPSILON;

double rounding_at_limit(const struct Instance *instance, const double *acceleration, size_t friction) {
  const struct SwitchTable *switches = lagrangian.switches;
  const double *force = acceleration + lagrangian.coordinate_count;
  double size = fabs(force[switches->frictions[friction].constraint]);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (rests_on(switches, friction, i))
      size = fmax(size, fabs(force[switches->contacts[i].constraint]) + carried_force(instance, i));
  return rounding_of_force * size;
}

double rounding_of_contacts(const struct Instance *instance, const double *acceleration) {
  const struct SwitchTable *switches = lagrangian.switches;
  const double *force = acceleration + lagrangian.coordinate_count;
  double size = 0.0;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (contact_holds(instance, i))
      size = fmax(size, fabs(force[switches->contacts[i].constraint] + carried_force(instance, i)));
  return rounding_of_force * size;
}

bool indicator_is_force(const struct Instance *instance, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t contacts = contact_indicator(switches, 0), frictions = friction_indicator(switches, 0);
  if (indicator < contacts) return false;
  if (indicator < frictions) return contact_holds(instance, indicator - contacts);
  return friction_holds(instance, indicator - frictions);
}

/* True if indicators need forces: a contact is closed, a friction sticks, or a branch switches by a force. */
static bool feels_forces(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool holds = switches->feels_forces;
  for (size_t i = 0; i < indicator_count(switches) && !holds; i++) holds = indicator_is_force(instance, i);
  return holds;
}

static bool indicators_at_point(struct Instance *instance, const struct Point *point, bool feels_forces,
                                double *indicator) {
  if (feels_forces) {
    instance->singular = lagrangian.constraints.accelerations(point, instance->acceleration);
    if (instance->singular != 0) return false;
  }
  lagrangian.switches->indicators(point, instance->acceleration, indicator);
  return true;
}

bool indicators_at(struct Instance *instance, double time, const double *state, double *indicator) {
  struct Point point = solver_point(instance, time, state);
  return indicators_at_point(instance, &point, feels_forces(instance), indicator);
}

double indicator_at(struct Instance *instance, double time, const double *state, size_t indicator, double *work) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_of_forces =
      indicator < switches->branch_count ? switches->feels_forces : indicator_is_force(instance, indicator);
  struct Point point = solver_point(instance, time, state);
  return indicators_at_point(instance, &point, is_of_forces, work) ? work[indicator] : NAN;
}

void indicators_at_times(struct Instance *instance, const double *times, size_t count, const double *states,
                         const double *accelerations, double *indicators) {
  size_t width = indicator_count(lagrangian.switches);
  size_t rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  struct Point point = instance_point(instance);
  bool forces = feels_forces(instance);
  for (size_t k = 0; k < count; k++) {
    double *row = indicators + k * width;
    bool are_known = true;
    solver_move_point(instance, &point, times[k], states + k * lagrangian.state_count);
    if (accelerations != NULL) lagrangian.switches->indicators(&point, accelerations + k * rows, row);
    else are_known = indicators_at_point(instance, &point, forces, row);
    for (size_t i = 0; i < width && !are_known; i++) row[i] = NAN;
  }
}

void indicator_rounding_bounds(struct Instance *instance, double time, const double *state, const double *acceleration,
                               double *error_bound) {
  struct Point point = solver_point(instance, time, state);
  lagrangian.switches->rounding_bounds(&point, acceleration, error_bound);
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++)
    error_bound[i] = isfinite(error_bound[i]) ? rounding_of_operation * error_bound[i] : 0.0;
}

double indicator_sign(const struct Instance *instance, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  return indicator < switches->branch_count ? instance->parameter[switches->branches[indicator].mode] : 1.0;
}

double round_state(const double *state, bool otherwise, double *rounded) {
  double distance = otherwise ? further : 1.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double size = fmax(fabs(state[i]), least_share * lagrangian.steps.nominal[i]);
    double change = distance * (double)(1 + (otherwise ? i * 3 % 7 : i * 7 % 5)) * DBL_EPSILON * size;
    rounded[i] = state[i] + ((otherwise ? i / 2 : i) % 2 == 0 ? change : -change);
  }
  return error_bound_of_difference / distance;
}

bool indicator_error_bound(struct Instance *instance, double time, const double *state, bool otherwise,
                           const double *indicator, double *rounded, double *error_bound) {
  double factor = round_state(state, otherwise, rounded);
  if (!indicators_at(instance, time * (1.0 + 4.0 * DBL_EPSILON), rounded, error_bound)) return false;
  for (size_t i = 0; i < indicator_count(lagrangian.switches); i++) {
    double change = factor * fabs(error_bound[i] - indicator[i]);
    error_bound[i] = isfinite(change) ? change : 0.0;
  }
  return true;
}
