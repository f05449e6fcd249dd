/* Time derivatives along the motion. */
#pragma once

#include "model/model.h"

/* The direction of d/dt in the space of all symbols, for derivative_along(): with the accelerations, or with 0 for them. */
Node *time_seeds(const struct Model *model, bool with_accelerations);
