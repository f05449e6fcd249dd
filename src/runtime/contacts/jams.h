/* Frictions at rest whose forces follow from forces of constraints: the one motion that their law allows. */
#ifndef JAMS_H
#define JAMS_H

#include "events/settlement.h"

/*
 * Sets the modes of frictions at rest, and of the branches that have switched, to the only ones with which accelerations and
 * forces agree. False where there are none, or too many to try, or more than one motion, which it logs.
 */
bool jams_resolve(struct Settlement *settlement);

#endif
