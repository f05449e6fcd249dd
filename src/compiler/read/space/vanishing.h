/*
 * A numerical test for expressions that are identically zero though simplification does not show it, as after rotations
 * by numeric angles.
 */
#pragma once

#include "model/kinematics.h"

/*
 * True if the expression is 0 to 12 digits of a scale at some samples of all symbols. The scale is 1, or for lengths
 * the largest coordinate of the positions. position_count may be 0.
 */
bool vanishes(const struct Graph *graph, Node node, const struct Vector *positions, size_t position_count);
