/* Frictions in planes at rest, and the contacts below them, whose forces depend on each other. */
#pragma once

#include "nonsmooth/planes/plane_state.h"

/*
 * Brings slow frictions to rest, solves for the forces of all contacts at rest and the frictions on them at once, and
 * sets their modes. False if there are no such forces, accelerations do not exist, or memory is missing, and on further
 * calls in an event resolution.
 */
bool plane_forces_resolve(struct Resolution *resolution);
