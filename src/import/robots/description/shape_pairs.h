/* Pairs of shapes of a robot that touch each other. */
#pragma once

#include <stdbool.h>

#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/* True if self="true" lets shapes of these types touch. */
bool shapes_can_touch(const struct Collision *first, const struct Collision *second);

/*
 * Sets the names of two shapes in the system that includes the robot; of collisions of links, by their indices. Returns
 * true if this system has a <contact> of its own between them.
 */
bool touch_in_system(const struct RobotOptions *options, const struct ShapePair *pair, char *names[2]);

/* Returns how two shapes that do not touch by themselves can be made to touch, for messages. */
char *how_to_touch(const struct RobotOptions *options, const struct ShapePair *pair);

/* Appends a pair to those of the robot. */
void add_shape_pair(struct Robot *robot, const struct ShapePair *pair);
