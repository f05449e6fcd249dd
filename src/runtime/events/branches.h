/* The pieces that expressions are in, and the sides of 0 on which those of events are. */
#ifndef BRANCHES_H
#define BRANCHES_H

#include "events/settlement.h"

/* Switches those of pieces, or the sides; *switched where any does. NULL, or the reason why one cannot. */
const char *branches_switch(struct Settlement *settlement, bool sides, bool *switched);

/* NULL, or the reason why an importer would come to a zero again and again: both sides of it lead back to it. */
const char *branches_check(struct Settlement *settlement);

/* As the signs of the start values say. False where there are no accelerations. */
bool branches_begin(struct Settlement *settlement);

/* Signs of the present values, without events: what a reader may expect before the simulation starts. */
void branches_guess(struct Instance *instance);

#endif
