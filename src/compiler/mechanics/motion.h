/* From a model to the equations of its FMU. */
#pragma once

#include "mechanics/equations.h"

/*
 * Derives the equations of motion, linearized if the model requests it, their switching and their method. Regularizes
 * coordinates without inertia in the model, see massless.h. Returns NULL after reporting errors.
 */
struct Equations *motion_of(struct Model *model, struct Diagnostics *diagnostics);
