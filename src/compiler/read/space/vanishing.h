/* What is 0 wherever the system is, although its expression may not show it: turns by numbers leave roundings of it. */
#pragma once

#include "model/kinematics.h"

/*
 * Whether the expression is 0, to 12 digits of the scale, in samples in which all symbols of the graph have other values. The scale is 1, or that
 * of the places (place_count, which may be 0), whose distances it is of.
 */
bool vanishes(const struct Graph *graph, Node node, const struct Vector *places, size_t place_count);
