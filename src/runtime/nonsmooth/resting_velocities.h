/* Velocities that constraints, closed contacts and sticking frictions keep at 0, and those of drives that dwell. */
#ifndef RESTING_VELOCITIES_H
#define RESTING_VELOCITIES_H

#include "nonsmooth/resolution.h"

/* Sets resolution->moves of each resting velocity to its mode. */
void resting_find(struct Resolution *resolution);

#endif
