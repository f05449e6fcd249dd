/* Starts the simulation and each of its steps: fulfils the constraints, and finds the modes, for the values set. */
#ifndef START_H
#define START_H

#include "instance/instance.h"

/* Computes the start of the simulation from the set values, after events there. Logs an error if there is none. */
enum Status start_find(struct Instance *instance);

/*
 * Brings constraints and modes into agreement with parameters, inputs and a state that were set, at the start of a
 * step. False after logging why the step is discarded.
 */
bool start_step(struct Instance *instance);

#endif
