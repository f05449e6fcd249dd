/* Impacts: what contacts that are hit at the same time, and the frictions that rest on them, do to the velocities. */
#ifndef IMPACTS_H
#define IMPACTS_H

#include "events/settlement.h"

/*
 * Changes the velocities by the impulses of the contacts that take part; bounces: with their restitutions, else without.
 * False where there are no such impulses.
 */
bool impacts_take(struct Settlement *settlement, bool bounces);

#endif
