/*
 * Checks of states of first order in positions, energies and constraints: the derivatives of a state that are needed
 * there must follow from its rate.
 */
#pragma once

#include "read/context/attributes.h"

/* Reports a state whose derivative is missing, after all elements were read. */
void check_moving_states(const struct Reader *reader);
