/* Velocities that frictions, contacts and constraints keep at 0, as seen by conditions, functions and outputs. */
#pragma once

#include "model/model.h"

/*
 * Replaces a velocity by an exact 0 while it rests: in the indicators of branches, in assignments of events, in outputs
 * and in rates of states. Constraints keep it at 0 up to rounding, and the sign of a rounding error must decide
 * nothing. The runtime finds which velocities rest (nonsmooth/rests/resting_velocities.c).
 */
void replace_resting_velocities(struct Model *model);

/* Returns the expression before this replacement, as pages show it. */
Node without_rests(const struct Model *model, Node node);

/*
 * Replaces symbols in the indicators of branches, in assignments of events, in outputs and in rates of states.
 * replacements has one element for each symbol.
 */
void substitute_in_observers(struct Model *model, const Node *replacements);
