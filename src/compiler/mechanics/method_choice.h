/* Which method solves the equations of a system. */
#pragma once

#include "mechanics/equations.h"

/* The one that the author chose, or what fits the equations; NULL without coordinates. */
const struct Method *method_of(const struct Model *model, const struct Equations *equations);
