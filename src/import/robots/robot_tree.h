/* Connects the links of a robot to a kinematic tree. */
#pragma once

#include <stdbool.h>

#include "base/diagnostics.h"
#include "robots/description/robot.h"
#include "robots/description/robot_symbols.h"

/* Sets the fields marked as results of robot_connect() in robot.h. Returns false after reporting errors. */
bool robot_connect(struct Robot *robot, struct Diagnostics *diagnostics);

/* Returns the link of this name; NULL after reporting that there is none. what: where the name is used. */
struct RobotLink *robot_link(const struct Robot *robot, const char *name, const char *what,
                             struct Diagnostics *diagnostics);

/* Returns the number of joints that move other links against this one. */
size_t moving_children(const struct Robot *robot, const struct RobotLink *link);

/*
 * Reports a link that turns freely, carries no others, and has no moment of inertia about an axis, or no mass although
 * it needs one.
 */
void robot_check_moments(const struct Robot *robot, const struct RobotLink *link, bool needs_mass, long line,
                         struct Diagnostics *diagnostics);

/* True if the joint has coordinates; false for NULL. */
bool joint_moves(const struct RobotJoint *joint);

/* True if the joint has one coordinate: revolute, continuous or prismatic. */
bool joint_is_single(const struct RobotJoint *joint);

/* Returns the gravitational acceleration of the file in m/s2. */
double robot_gravity(const struct Robot *robot);

/* True if the link moves, itself or by the link that it is fixed to. */
bool carrier_moves(const struct RobotLink *link, bool floats);
