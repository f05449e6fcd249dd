/*
 * Sensitivities as part of the motion: derivatives of coordinates and states with respect to parameters, inputs and
 * start values. They obey the variational equations, and are coordinates whose acceleration is prescribed.
 */
#pragma once

#include "mechanics/equations.h"

/*
 * Adds for each name the coordinates COORDINATE.by.NAME with their velocities, the states STATE.by.NAME and the outputs
 * OUTPUT.by.NAME. equations: those of the model before, with all accelerations as expressions.
 *
 * The start value of a sensitivity is 0, or 1 with respect to the start value itself. Sensitivities satisfy the
 * linearized constraints as far as their start values do. At events, where sensitivities jump, they must be set.
 * Results are wrong if constraints are redundant, which no expression shows. Reports systems that cannot be
 * differentiated in this way.
 */
void add_sensitivities(struct Model *model, const struct Equations *equations, const char *const *names, size_t count,
                       struct Diagnostics *diagnostics);
