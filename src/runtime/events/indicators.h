/* What changes its sign where a mode may change. */
#ifndef INDICATORS_H
#define INDICATORS_H

#include "instance/switching.h"

/* The indicators at a time and state; false where there are no accelerations, or a value is not finite. */
bool switching_indicators(struct Instance *instance, double time, const double *state, double *indicator);

/* A state that differs from another by what rounding may do to it, in one way or otherwise. */
void switching_round(const double *state, bool otherwise, double *rounded);

/* 1, -1 or 0: the sign that an indicator has while its mode stays; 0 of a branch that rests at 0. */
double switching_sign(const struct Instance *instance, size_t indicator);

/* How far below 0 an event may leave an indicator, in units of what rounding makes of it. */
enum { FLOOR_IN_NOISE = 64 };

#endif
