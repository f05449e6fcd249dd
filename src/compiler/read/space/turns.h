/* <rotate>: how a frame is turned, by an angle about an axis or by a quaternion. */
#pragma once

#include "read/context/attributes.h"

/* The <rotate> with a quaternion among the steps of a <frame>; NULL where there is none. */
xmlNodePtr quaternion_of(xmlNodePtr frame);

/* Reports a <rotate> whose attributes do not fit together. */
void check_turn(struct Reader *reader, xmlNodePtr node);

/* Turns the pose as a <rotate> says. */
void turn(struct Reader *reader, xmlNodePtr node, struct Pose *pose);
