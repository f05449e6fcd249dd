/* What a joint of a robot becomes: coordinates, motors, losses, limits, and the motion of a frame. */
#pragma once

#include "read/robots/description/robot.h"
#include "read/robots/robot_elements.h"

/* The parameters that the friction of joints shares. */
void write_friction_parameters(const struct Writer *writer, const struct Robot *robot);

/* Coordinates and what else there is of a joint beside its frame. */
void write_joint(const struct Writer *writer, const struct Joint *joint);

/* The input NAME_control of an actuator, and what it makes of it. */
void write_actuator(const struct Writer *writer, const struct Actuator *actuator);

/* The six degrees of freedom of a free body, in coordinates whose names begin with this one. */
void write_free_coordinates(const struct Writer *writer, const char *name, const struct JointStart *start,
                            const char *description);

/* Turns and moves the frame of the joint's child by the coordinates. */
void write_motion(const struct Writer *writer, xmlNodePtr frame, const struct Joint *joint);
void write_free_motion(const struct Writer *writer, xmlNodePtr frame, const char *name);
