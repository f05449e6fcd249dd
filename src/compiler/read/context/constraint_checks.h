/* What the expressions of constraints have to be. */
#pragma once

#include "read/context/attributes.h"

/* Reports a constraint that holds nothing, or is not linear in the velocities; notes one that moves by itself. */
void check_constraint(struct Reader *reader, const struct Variable *constraint);
