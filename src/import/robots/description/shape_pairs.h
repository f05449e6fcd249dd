/* Pairs of shapes of a robot that touch each other. */
#pragma once

#include <stdbool.h>

#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/* True if self="true" lets shapes of these types touch. */
bool shapes_can_touch(const struct Collision *first, const struct Collision *second);

/* Returns the name that a collision of a link has as a shape. */
char *collision_name(const struct RobotLink *link, size_t index);

/* True if the system that includes the robot has a <contact> of its own between two shapes of the robot. */
bool has_contact_between(const struct RobotOptions *options, const char *first, const char *second);

/* The same for a pair. */
bool touch_in_system(const struct RobotOptions *options, const struct ShapePair *pair);

/* Returns how two shapes that do not touch by themselves can be made to touch, for messages. */
char *how_to_touch(const struct RobotOptions *options, const struct ShapePair *pair);

/* Appends a pair to those of the robot. */
void add_shape_pair(struct Robot *robot, const struct ShapePair *pair);
