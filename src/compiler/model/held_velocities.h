/* Velocities at which friction sticks, as conditions, pieces of functions and outputs see them. */
#pragma once

#include "model/model.h"

/*
 * Puts an exact 0 for a velocity that a friction holds, while it does, into what looks at it: the indicators of branches, what
 * events assign, and outputs. The constraint that holds the velocity leaves it a rounding error, whose sign decides nothing.
 */
void hold_velocities(struct Model *model);

/* Replaces symbols in the indicators of branches, in what events assign, and in outputs. */
void substitute_in_observers(struct Model *model, const Node *replacements);
