/* Pairs of shapes of a robot that touch each other. */
#pragma once

#include <stdbool.h>

#include "robots/description/robot.h"

/* True if a <contact between and> is possible for shapes of these types. */
bool shapes_can_touch(const struct Collision *first, const struct Collision *second);

/* Appends a pair to those of the robot. */
void add_shape_pair(struct Robot *robot, const struct ShapePair *pair);
