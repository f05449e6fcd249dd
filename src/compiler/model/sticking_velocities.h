/* Velocities of sticking frictions, as seen by conditions, piecewise functions and outputs. */
#pragma once

#include "model/model.h"

/*
 * Replaces a velocity by an exact 0 while a friction sticks at it: in the indicators of branches, in assignments of
 * events, in outputs and in rates of states. The constraint keeps the velocity at 0 up to rounding, and the sign of a
 * rounding error must decide nothing.
 */
void replace_sticking_velocities(struct Model *model);

/*
 * Replaces symbols in the indicators of branches, in assignments of events, in outputs and in rates of states.
 * replacements has one element for each symbol.
 */
void substitute_in_observers(struct Model *model, const Node *replacements);
