/* From a model to the equations that its FMU has. */
#pragma once

#include "mechanics/equations.h"

/*
 * The equations of motion, linearised where the model asks for it, with what switches them and the method that solves
 * them. Coordinates without inertia get one in the model, see massless.h. NULL after reporting errors.
 */
struct Equations *motion_of(struct Model *model, struct Diagnostics *diagnostics);
