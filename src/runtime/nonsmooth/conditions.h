/* <event> elements: each happens when its condition becomes true. */
#pragma once

#include "nonsmooth/resolution.h"

/* Stores the conditions and signs at the start of an event resolution. */
void conditions_begin(struct Resolution *resolution);

/*
 * Lets all events happen whose conditions have become true, with the values before them; sets *again if there are any.
 * Returns NULL, or the reason why they cannot.
 */
const char *conditions_happen(struct Resolution *resolution, bool *again);
