/*
 * <joint>: constraints between two frames, points or bodies. What they hold, and their forces, are along the axes of the
 * frame that `from` names or is in.
 */
#pragma once

#include "read/context/attributes.h"

/* Declares the constraints of the joint: their forces are NAME.forceX, ..., NAME.torqueX, .... */
void declare_joint(struct Reader *reader, xmlNodePtr node);

/* Gives them their expressions, when all frames are known. */
void read_joint(struct Reader *reader, xmlNodePtr node);
