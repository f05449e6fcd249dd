/* A step of Moreau's time stepping, for motions whose events follow each other too fast to be found one by one. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Moves the state on by a length of time, whatever events happen in it, and sets the modes to those of the step. *longest
 * is the time in which the accelerations without contacts change positions by the tolerance. The length is a share of it,
 * and at most limit. The error is of the order of the length. Returns the length, or 0 if there are no impulses, or memory
 * is missing.
 */
double time_step(struct Resolution *resolution, double share, double limit, double *longest);

/* Opens all contacts, and lets the frictions on them slide: no other modes may agree with the state behind a step. */
void release_contacts(struct Resolution *resolution);
