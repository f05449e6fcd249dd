/* Start of the simulation and of each step: satisfies the constraints and finds the modes for the values set. */
#pragma once

#include "instance/instance.h"

/* Computes the state at the start from the values set, after any events there. Logs an error if there is none. */
enum Status start_find(struct Instance *instance);

/*
 * Brings constraints and modes into agreement with parameters, inputs and a state that were set, at the start of a
 * step. False after logging why the step is discarded.
 */
bool start_step(struct Instance *instance);
