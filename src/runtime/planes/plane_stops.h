/* Where friction in a plane comes to rest. */
#ifndef PLANE_STOPS_H
#define PLANE_STOPS_H

#include "planes/plane_state.h"

/*
 * Lets all that are slow stick, and again slide, one by one, where one would need more than its stiction; what sticks then is
 * brought to rest. False where there are no accelerations, or it cannot be.
 */
bool planes_stop(struct Settlement *settlement);

#endif
