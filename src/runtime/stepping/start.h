/*
 * How the simulation and each of its steps set out: constraints fulfilled, and modes found, from the values that were set.
 */
#ifndef START_H
#define START_H

#include "instance/instance.h"

/*
 * Brings the instance from the values that were set to the start of the simulation, behind impacts and events at the start
 * itself; an error, logged, where there is none.
 */
enum Status start_find(struct Instance *instance);

/*
 * Brings constraints and modes into agreement with parameters, inputs and a state that were set, as a step begins. False
 * after logging why the step is discarded.
 */
bool start_step(struct Instance *instance);

#endif
