/* Branches that depend only on time. */
#ifndef TIME_EVENTS_H
#define TIME_EVENTS_H

#include "nonsmooth/resolution.h"

/* Evaluates value[] of the switch table at a time. Values that depend on accelerations are undefined. */
void time_events_values(struct Resolution *resolution, double time);

#endif
