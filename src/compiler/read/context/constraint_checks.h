/* Checks of the expressions of constraints. */
#pragma once

#include "read/context/attributes.h"

/*
 * Reports a constraint that contains no coordinate or velocity, or is not linear in the velocities. Records one that
 * prescribes a motion, and reports inputs in it without the necessary derivatives.
 */
void check_constraint(struct Reader *reader, const struct Variable *constraint);
