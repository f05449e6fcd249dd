/* The <event> elements: each happens when its condition comes to hold. */
#ifndef CONDITIONS_H
#define CONDITIONS_H

#include "events/settlement.h"

/* Conditions and sides from which the settlement sets out. */
void conditions_begin(struct Settlement *settlement);

/*
 * Lets events happen whose condition has come to hold, all with the values before them; *again where there are any. NULL, or
 * the reason why they cannot.
 */
const char *conditions_happen(struct Settlement *settlement, bool *again);

#endif
