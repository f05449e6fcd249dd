/* Impacts: the impulses of contacts that are hit at the same time, and of the frictions on them. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Changes the velocities by the impulses of the contacts that take part; by Newton's law of restitution if bounces,
 * else without restitution. False, after logging the cause, if no impulses are found.
 */
bool impacts_take(struct Resolution *resolution, bool bounces);
