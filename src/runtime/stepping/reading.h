/*
 * What is told of an instance: in initialization mode its start, and between steps, where a value was set, what the next one
 * begins with. It is found on a copy, so that reading leaves no trace: what is set are the values that it is found from.
 */
#ifndef READING_H
#define READING_H

#include "instance/instance.h"

/*
 * Between these two, variables have the values that they are told with; nothing may be set. Where there is no start, a warning
 * says once why, and the values stay as they were set; so they do where the next step will be discarded.
 */
void reading_begin(struct Instance *instance);
void reading_end(struct Instance *instance);

/*
 * While variables are read in initialization mode: how the start, moved onto the constraints, changes along a direction of what was
 * set. seed->state is state[state_count], the direction of the states that were set, which becomes that of the start. Discards
 * where there is no start nearby.
 */
enum Status reading_follow_start(struct Instance *instance, const struct Seed *seed, double *state);

#endif
