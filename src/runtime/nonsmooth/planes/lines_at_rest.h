/* Frictions along lines at rest. Their forces are found together with those in planes (rest_forces.c). */
#pragma once

#include "nonsmooth/planes/rest_forces.h"

/* Sets the part of each friction along a line. */
void lines_choose(const struct Resolution *resolution);

/*
 * Lets a friction stick that carries a share of its sliding force; its constraint carries the rest of the load. With
 * line_release() it has the force of this share without a constraint.
 */
void line_carry(struct Resolution *resolution, size_t friction, double share);
void line_release(struct Resolution *resolution, size_t friction, double share);

/*
 * Keeps the force of a friction that sticks, without its constraint, while others constrain its velocity. It is
 * reported as sticking.
 */
void line_keep(struct Resolution *resolution, size_t friction);

/* Lets those that take part stick. */
void lines_stick(struct Resolution *resolution);

/* True if one that takes part and sticks needs more than its stiction by `rounding`, in N. */
bool lines_exceed(const struct Resolution *resolution, double rounding);

/* Sets their modes by the solution: those that slip push against their motion, the others stick. */
void lines_take(struct RestForces *forces);

/* Lets those slip that still need more than their stiction, as within rounding. False if accelerations do not exist. */
bool lines_let_overcome_slip(struct RestForces *forces);
