/*
 * Frictions along lines beside those in planes at rest. Their forces are found together (rest_forces.c). They carry no
 * given force: those that would exceed their limits act with these.
 */
#pragma once

#include "nonsmooth/planes/rest_forces.h"

/* Sets the part of each friction along a line. */
void lines_choose(const struct Resolution *resolution);

/* Lets those that take part stick. */
void lines_stick(struct Resolution *resolution);

/* True if one that takes part and sticks needs more than its stiction by `rounding`, in N. */
bool lines_exceed(const struct Resolution *resolution, double rounding);

/* Sets their modes by the solution: those that slip push against their motion, the others stick. */
void lines_take(struct RestForces *forces);

/*
 * Lets frictions act with their limits at rest, one after another, as long as one exceeds its own. The forces of those
 * that stick are shared by least norm. False if accelerations do not exist.
 */
bool lines_act(struct RestForces *forces);
