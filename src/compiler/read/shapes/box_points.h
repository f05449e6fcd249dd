/* Points at which two boxes touch. */
#pragma once

#include "read/shapes/shape_pair.h"

/* The number of points of two boxes: four corners of each, and two edges of each for each pair of their directions. */
enum { POINTS_OF_BOXES = 44 };

/* Appends the contacts of two boxes: those of corners of the first, corners of the second, and of edges. */
void boxes_contacts(const struct ShapePair *pair, struct ContactPoints *contacts);
