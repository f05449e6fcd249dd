/*
 * Coordinates without inertia, of which M is singular while K = (M J^T; J 0) is not: massless links, whose motion
 * constraints tell.
 */
#pragma once

#include "model/model.h"

/* Gives an inertia to the rates of the constraints that hold such coordinates, where they make M regular so. */
void hold_massless_coordinates(struct Model *model);
