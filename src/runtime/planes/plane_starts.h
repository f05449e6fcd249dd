/* Direction in which friction in a plane begins to slide. */
#ifndef PLANE_STARTS_H
#define PLANE_STARTS_H

#include "planes/plane_state.h"

/*
 * Rotates the slip directions of all frictions that begin to slide until each accelerates along its own; sets *changed
 * if one did not. *stays: a friction that accelerates along no direction, and must stick; plane_count for none.
 * False if accelerations do not exist, or the directions do not converge.
 */
bool plane_slip_directions_find(struct Resolution *resolution, bool *changed, size_t *stays);

#endif
