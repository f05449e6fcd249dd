/* Frictions in planes that come to rest. */
#ifndef PLANE_STOPS_H
#define PLANE_STOPS_H

#include "planes/plane_state.h"

/*
 * Lets all slow frictions stick; those that would need more than their stiction, and cannot share their load, slide
 * again, one by one. The others are brought to rest. False if accelerations do not exist, or velocities cannot be
 * projected.
 */
bool planes_stop(struct Resolution *resolution);

#endif
