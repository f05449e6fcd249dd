/* Frictions at rest whose forces follow from constraint forces: the only motion that Coulomb's law allows. */
#ifndef JAMS_H
#define JAMS_H

#include "events/settlement.h"

/*
 * Sets the modes of frictions at rest, and of branches that have switched, to the only consistent ones. False if there
 * are none, too many to try, or several motions, which it logs.
 */
bool jams_resolve(struct Settlement *settlement);

#endif
