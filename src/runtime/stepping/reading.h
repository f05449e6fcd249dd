/*
 * Reported values: in initialization mode those of the start; between steps, after a value was set, those with which
 * the next step starts. They are computed on a copy, so that reading changes nothing: the start always follows from the
 * values that were set.
 */
#pragma once

#include "instance/instance.h"

/*
 * Begin and end reading: between these calls variables have their reported values, and nothing may be set. If there is
 * no start, a warning says why, once, and the values are those that were set. The same holds if the next step will be
 * discarded.
 */
void reading_begin(struct Instance *instance);
void reading_end(struct Instance *instance);

/*
 * Replaces state[state_count] (seed->state), a direction of the states that were set, by that of the start, which is
 * projected onto the constraints. Only while variables are read in initialization mode. Discards if there is no start
 * nearby.
 */
enum Status reading_follow_start(struct Instance *instance, const struct Seed *seed, double *state);
