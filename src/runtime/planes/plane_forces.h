/* How frictions in planes and the contacts below them go on from rest where they decide on one another. */
#ifndef PLANE_FORCES_H
#define PLANE_FORCES_H

#include "planes/plane_state.h"

/*
 * Brings the frictions that are slow to rest, finds the forces of all contacts at rest and of the frictions at rest on them at
 * once, and sets their modes by these. False where there are none, or no accelerations.
 */
bool plane_forces_settle(struct Settlement *settlement);

#endif
