/* Impacts: the impulses of contacts that are hit at the same time, and of the frictions on them. */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/resolution.h"

/*
 * Changes the velocities by the impulses of the contacts that take part; by Newton's law of restitution if bounces,
 * else without restitution. False, after logging the cause, if no impulses are found.
 */
bool impacts_take(struct Resolution *resolution, bool bounces);

/* Changes the velocities by the impulse of a row. */
void impact_add(struct Resolution *resolution, const struct ContactImpulses *impulses, size_t row, double impulse);

/*
 * Returns the restitution of a contact; 0 if the bounce would be lost in errors. The friction of a bounce that is cut
 * short is then that of rest, whose impulse equals the sum of all further bounces.
 */
double impact_restitution(const struct Resolution *resolution, size_t contact);
