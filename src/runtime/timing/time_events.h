/* Branches that time alone turns. */
#ifndef TIME_EVENTS_H
#define TIME_EVENTS_H

#include "events/settlement.h"

/* Fills value[] of the switch table at a time. What depends on accelerations is undefined. */
void time_events_values(struct Settlement *settlement, double time);

#endif
