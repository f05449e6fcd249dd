/* The system where it starts, and where it may be else: values of all nodes, with coordinates that fulfil the constraints. */
#pragma once

#include "model/model.h"

/*
 * The values of all nodes at the start, with the coordinates moved there by offsets (NULL for none) and then back, by as little as
 * it takes, to where the constraints are fulfilled. NULL where that fails. Of constraints on many coordinates it takes no notice.
 */
double *values_at(const struct Model *model, const double *offsets);

/* Whether the constraint is one of positions that holds at every time: not that of a contact or of friction. */
bool holds_positions(const struct Model *model, size_t constraint);
