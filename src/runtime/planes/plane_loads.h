/* Frictions in planes that stick and carry a load together. */
#ifndef PLANE_LOADS_H
#define PLANE_LOADS_H

#include "planes/plane_state.h"

/*
 * Handles a sticking friction that reaches its limit: the frictions that can take its load share it within their
 * limits, or begin to slide together. False if they cannot, or need not.
 */
bool plane_loads_share(struct Settlement *settlement, size_t plane);

#endif
