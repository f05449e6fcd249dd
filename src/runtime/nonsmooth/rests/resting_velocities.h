/* Velocities that constraints, closed contacts and sticking frictions keep at 0, and those of drives that dwell. */
#pragma once

#include "nonsmooth/resolution.h"

/* Sets resolution->moves of each resting velocity to its mode. */
void resting_find(struct Resolution *resolution);
