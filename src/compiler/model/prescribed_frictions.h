/* Frictions along prescribed velocities: those given by prescribed motions, inputs or time. */
#pragma once

#include "model/model.h"

/*
 * Finds such frictions. Removes their constraints, since velocity = 0 would contradict the prescribed motion. The mode
 * of each becomes that of a branch with the velocity as its indicator; a friction in a plane keeps its own mode.
 */
void find_prescribed_frictions(struct Model *model);
