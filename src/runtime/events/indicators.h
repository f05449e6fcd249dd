/* What changes its sign where a mode may change. */
#ifndef INDICATORS_H
#define INDICATORS_H

#include "instance/event_laws.h"

/* The indicators at a time and state; false where there are no accelerations, or a value is not finite. */
bool indicators_at(struct Instance *instance, double time, const double *state, double *indicator);

/* The same at several times, from rows of states to rows of indicators, which are NAN where there are none. */
void indicators_at_times(struct Instance *instance, const double *times, size_t count, const double *states,
                         double *indicators);

/* Whether an indicator is a force now: of a contact that is closed, or of a friction that sticks. */
bool indicator_is_force(const struct Instance *instance, size_t indicator);

/*
 * What the roundings of their own operations make of the indicators of branches, the gaps and the velocities of frictions,
 * whatever the modes; acceleration as for indicators().
 */
void indicator_roundings(struct Instance *instance, double time, const double *state, const double *acceleration,
                         double *noise);

/*
 * A state that differs from another by what rounding may do to it, in one way or, several times as far, otherwise. Returns
 * the noise of a value in units of what this changes it by.
 */
double round_state(const double *state, bool otherwise, double *rounded);

/*
 * What rounding the time and the state in one of these ways makes of the indicators there; rounded[state_count] is
 * workspace. False where they have no values.
 */
bool indicator_noise(struct Instance *instance, double time, const double *state, bool otherwise,
                     const double *indicator, double *rounded, double *noise);

/* 1, -1 or 0: the sign that an indicator has while its mode stays; 0 of a branch that rests at 0. */
double indicator_sign(const struct Instance *instance, size_t indicator);

/* How far below 0 an event may leave an indicator, in units of what rounding makes of it. */
enum { FLOOR_IN_NOISE = 64 };

#endif
