/* Branches: pieces of piecewise functions, and the last nonzero signs of the expressions of events. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Switches the pieces of functions, or, with last_signs, the signs of events' expressions; sets *switched if any
 * changed. Returns NULL, or the reason why one cannot.
 */
const char *branches_switch(struct Resolution *resolution, bool last_signs, bool *switched);

/*
 * Switches the branch of a located event if the forces have a kink there. The accelerations and all other signs stay
 * then, and so do all other modes. Else returns false, and changes nothing.
 */
bool branches_pass_kink(struct Resolution *resolution);

/* Returns NULL, or the reason why an importer would come back to a zero again and again: both signs lead back to it. */
const char *branches_check(struct Resolution *resolution);

/* Sets the signs from the start values. False if the accelerations do not exist. */
bool branches_begin(struct Resolution *resolution);

/* Sets the signs from the present values, without events, for reading before the start. */
void branches_guess(struct Instance *instance);
