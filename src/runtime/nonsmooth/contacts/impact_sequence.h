/* The impacts of an event, one after another. */
#pragma once

#include "nonsmooth/resolution.h"

/* The reason why the motion ends where no impulses are found. */
extern const char impact_without_solution[];

/* Opens all contacts behind an impact, whose impulses have changed the velocities. */
void impact_leave_open(struct Resolution *resolution);

/*
 * Takes impacts while contacts that touch close; all contacts are open then. False, with *problem as it was, if none
 * closes. *problem: NULL, or the reason why the motion cannot continue.
 */
bool takes_impacts(struct Resolution *resolution, const char **problem);
