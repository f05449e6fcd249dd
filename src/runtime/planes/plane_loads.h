/* Frictions in planes that stick and carry a load together. */
#ifndef PLANE_LOADS_H
#define PLANE_LOADS_H

#include "planes/plane_state.h"

/*
 * One that sticks and comes to its limit: those that can take what it carries share all of it, within their limits, or begin to
 * slide together. False where they cannot, or need not.
 */
bool plane_loads_share(struct Settlement *settlement, size_t plane);

#endif
