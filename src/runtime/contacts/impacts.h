/* Impacts: what contacts that are hit at the same time, and the frictions that rest on them, do to the velocities. */
#ifndef IMPACTS_H
#define IMPACTS_H

#include "events/settlement.h"

/*
 * Changes the velocities by the impulses of the contacts that take part; bounces: with their restitutions, else without.
 * False where there are no such impulses.
 */
bool impacts_take(struct Settlement *settlement, bool bounces);

struct Pushes;

/* Whether impulses make another motion than those that were found, by more than rounding, and gain no energy. */
bool is_other_outcome(const struct Pushes *pushes, const double *impulse, const double *found);

#endif
