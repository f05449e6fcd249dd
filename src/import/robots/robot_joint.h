/* Converts a joint of a robot to coordinates, inputs, friction, limits and the motion of a frame. */
#pragma once

#include "robots/description/robot.h"
#include "robots/robot_elements.h"

/* Writes the parameters that the friction of all joints shares. */
void write_friction_parameters(const struct Writer *writer, const struct Robot *robot);

/* Writes the coordinates of a joint, and its other elements except its frame. */
void write_joint(const struct Writer *writer, const struct RobotJoint *joint);

/* True if a joint with one degree of freedom is prismatic. */
bool joint_slides(const struct RobotJoint *joint);

/* Returns the unit of the position of a joint with one degree of freedom. */
const char *joint_unit(const struct RobotJoint *joint);

/* Return expressions of the joint's position, and of the ratio of its velocity to that of its leader. */
char *joint_position(const struct RobotJoint *joint);
char *joint_ratio(const struct RobotJoint *joint);

/* Writes the coordinates of a free body, a position and a quaternion. name: their prefix. */
void write_free_coordinates(const struct Writer *writer, const char *name, const struct JointStart *start,
                            const char *description);

/* Write the translation and rotation of the child's frame by the joint's coordinates. */
void write_motion(const struct Writer *writer, xmlNodePtr frame, const struct RobotJoint *joint);
void write_free_motion(const struct Writer *writer, xmlNodePtr frame, const char *name);
