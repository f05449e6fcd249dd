/* Time derivatives along the motion. */
#pragma once

#include "model/model.h"

/*
 * Returns the seeds of d/dt for derivative_along(), one for each symbol of the graph. Accelerations of free coordinates
 * are their symbols, or 0 without with_accelerations.
 */
Node *time_seeds(const struct Model *model, bool with_accelerations);
