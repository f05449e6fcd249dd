/* Frictions in planes that stick and carry a load together. */
#ifndef PLANE_LOADS_H
#define PLANE_LOADS_H

#include "planes/plane_state.h"

/*
 * Handles a sticking friction that exceeds its stiction. Frictions that can take its load share it within their
 * limits, or those at their limits begin to slide. False if it has no others, if every distribution exceeds the
 * limits, or after SHARE_LIMIT switches of it in an event.
 */
bool plane_loads_share(struct Resolution *resolution, size_t plane);

#endif
