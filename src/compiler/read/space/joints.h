/*
 * <joint>: constraints between two frames, points or bodies. The constrained components and their forces are along the
 * axes of the frame of `from`.
 */
#pragma once

#include "read/context/attributes.h"

/* Declares the constraints of the joint. Their forces are NAME.forceX, ..., NAME.torqueX, .... */
void declare_joint(struct Reader *reader, xmlNodePtr node);

/* Collects the forces and torques that are fractions of a constraint's force, depending on the axes of both ends. */
void collect_joint(struct Reader *reader, xmlNodePtr node);

/* Reads one of these by its name. */
struct Quantity read_joint_force(struct Reader *reader, xmlNodePtr node, const char *name);

/* Reads the expressions of the joint's constraints, when all frames are known. */
void read_joint(struct Reader *reader, xmlNodePtr node);
