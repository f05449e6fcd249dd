/*
 * What a motion depends on values by, as a part of the motion: of each coordinate its derivatives by given parameters, inputs
 * and start values, which move by the variational equations, as coordinates whose acceleration is given.
 */
#pragma once

#include "mechanics/equations.h"

/*
 * Adds to the model, for each of the names, the coordinates COORDINATE.by.NAME with their velocities, and the outputs
 * OUTPUT.by.NAME, and of <work/> its derivative; the equations are those of the model without them, their accelerations all
 * expressions. They start with 0, or 1 of the start value itself, and stay on the linearised constraints as they begin; at
 * events, where they jump, they are set. They are wrong where constraints follow from others, which no expression shows.
 * Reports what cannot be differentiated so.
 */
void add_variations(struct Model *model, const struct Equations *equations, const char *const *names, size_t count,
                    struct Diagnostics *diagnostics);
