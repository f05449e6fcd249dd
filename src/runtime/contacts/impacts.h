/* Impacts: the impulses of contacts that are hit at the same time, and of the frictions on them. */
#ifndef IMPACTS_H
#define IMPACTS_H

#include "events/settlement.h"

/*
 * Changes the velocities by the impulses of the contacts that take part; with their restitutions if bounces. False if
 * there are no such impulses.
 */
bool impacts_take(struct Settlement *settlement, bool bounces);

struct Pushes;

/* True if impulses make another motion than found, by more than rounding, and gain no energy. */
bool is_other_outcome(const struct Pushes *pushes, const double *impulse, const double *found);

#endif
