/* <rotate>: rotations of a frame by an angle about an axis, or by a quaternion. */
#pragma once

#include "read/context/attributes.h"

/* Returns the <rotate> with a quaternion in a <frame>; NULL for none. */
xmlNodePtr quaternion_of(xmlNodePtr frame);

/* Reports a <rotate> with an invalid combination of attributes. */
void check_rotation(struct Reader *reader, xmlNodePtr node);

/* Rotates the pose by a <rotate>. */
void rotate(struct Reader *reader, xmlNodePtr node, struct Pose *pose);
