/* Frictions in planes that stick with the forces that were found for them. */
#pragma once

#include "nonsmooth/planes/rest_forces.h"

/*
 * Lets frictions that do not slip stick with the forces that were found, and contacts carry those that balance them. The
 * constraints of all then begin with 0, and do not redistribute what was found. False if accelerations do not exist.
 */
bool carried_forces_take(struct RestForces *forces);
