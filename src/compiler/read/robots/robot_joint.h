/* What a joint of a robot becomes: coordinates, motors, losses, limits, and the motion of a frame. */
#pragma once

#include "read/robots/description/robot.h"
#include "read/robots/robot_elements.h"

/* The parameters that the friction of joints shares. */
void write_friction_parameters(const struct Writer *writer, const struct Robot *robot);

/* Coordinates and what else there is of a joint beside its frame. */
void write_joint(const struct Writer *writer, const struct Joint *joint);

/* Of a joint with one degree of freedom: whether it slides, and the unit of its position. */
bool joint_slides(const struct Joint *joint);
const char *joint_unit(const struct Joint *joint);

/* Its position, and what the velocity of its leader is multiplied by for its own, as expressions. */
char *joint_position(const struct Joint *joint);
char *joint_ratio(const struct Joint *joint);

/* The six degrees of freedom of a free body, in coordinates whose names begin with this one. */
void write_free_coordinates(const struct Writer *writer, const char *name, const struct JointStart *start,
                            const char *description);

/* Turns and moves the frame of the joint's child by the coordinates. */
void write_motion(const struct Writer *writer, xmlNodePtr frame, const struct Joint *joint);
void write_free_motion(const struct Writer *writer, xmlNodePtr frame, const char *name);
