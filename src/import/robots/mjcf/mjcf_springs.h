/* Springs and dampers that MJCF gives by a time constant and a damping ratio. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Notes a joint with the attribute springdamper, of positive numbers. Reports others. */
void mjcf_note_spring(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint);

/* Sets stiffness and damping of the noted joints, once all bodies have been read. */
void mjcf_set_springs(struct Mjcf *mjcf);
