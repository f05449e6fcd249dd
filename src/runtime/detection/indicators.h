/* Indicators: values whose change of sign may change a mode. */
#pragma once

#include "instance/event_laws.h"

/* Evaluates the indicators at a time and state. False if the accelerations do not exist. */
bool indicators_at(struct Instance *instance, double time, const double *state, double *indicator);

/*
 * Returns one indicator at a time and state; NAN if the accelerations do not exist. Those of gaps and velocities need no
 * accelerations. work: as for indicators_at().
 */
double indicator_at(struct Instance *instance, double time, const double *state, size_t indicator, double *work);

/*
 * Evaluates the indicators at several times, from rows of states to rows of indicators; NAN if they do not exist.
 * accelerations: rows of them and of constraint forces, if they are known; else NULL.
 */
void indicators_at_times(struct Instance *instance, const double *times, size_t count, const double *states,
                         const double *accelerations, double *indicators);

/* True if an indicator is a force at present: of a closed contact, or of a friction that sticks. */
bool indicator_is_force(const struct Instance *instance, size_t indicator);

/*
 * Computes bounds of the rounding errors by their own operations, for the indicators of branches, gaps and velocities
 * of frictions, in any mode. acceleration: as for indicators() of struct SwitchTable.
 */
void indicator_rounding_bounds(struct Instance *instance, double time, const double *state, const double *acceleration,
                               double *error_bound);

/*
 * Perturbs a state by rounding errors in one of two patterns, so that the errors cannot cancel in both; the second one
 * is larger. Returns the factor from the change of a value to its rounding error bound.
 */
double round_state(const double *state, bool otherwise, double *rounded);

/*
 * Computes rounding error bounds of the indicators by perturbing the time and the state in one of these patterns.
 * rounded: state_count of workspace. False if the indicators do not exist.
 */
bool indicator_error_bound(struct Instance *instance, double time, const double *state, bool otherwise,
                           const double *indicator, double *rounded, double *error_bound);

/* Returns the sign that an indicator has while its mode stays: 1, -1, or 0 for a branch at rest at 0. */
double indicator_sign(const struct Instance *instance, size_t indicator);

/* Returns the rounding error of the forces of closed contacts, in N or N*m. */
double rounding_of_contacts(const struct Instance *instance, const double *acceleration);

/*
 * Returns the rounding error of the force of a friction beside its limit. The perturbations above miss that of forces
 * which do not depend on the state.
 */
double rounding_at_limit(const struct Instance *instance, const double *acceleration, size_t friction);

/* How far an event may leave an indicator below 0, in units of its rounding error bound. */
enum { FLOOR_IN_ERROR_BOUND = 64 };
