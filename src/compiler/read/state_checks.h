/* States of first order in positions, energies and constraints: whether the derivatives that these need follow from their rates. */
#pragma once

#include "read/context/attributes.h"

/* Reports a state of which a derivative is missing, after all elements were read. */
void check_moving_states(const struct Reader *reader);
