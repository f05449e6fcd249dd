/*
 * <joint>: constraints between two frames, points or bodies. What they hold, and their forces, are along the axes of the
 * frame that `from` names or is in.
 */
#pragma once

#include "read/context/attributes.h"

/* Declares the constraints of the joint: their forces are NAME.forceX, ..., NAME.torqueX, .... */
void declare_joint(struct Reader *reader, xmlNodePtr node);

/* Collects the forces and torques that are a share of a constraint's force, which the axes of both sides tell. */
void collect_joint(struct Reader *reader, xmlNodePtr node);

/* One of these by its name. */
struct Quantity read_joint_force(struct Reader *reader, xmlNodePtr node, const char *name);

/* Gives them their expressions, when all frames are known. */
void read_joint(struct Reader *reader, xmlNodePtr node);
