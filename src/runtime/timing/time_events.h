/* Branches that depend only on time. */
#pragma once

#include "nonsmooth/resolution.h"

/* Evaluates value[] of the switch table at a time. Values that depend on accelerations are undefined. */
void time_events_values(struct Resolution *resolution, double time);
