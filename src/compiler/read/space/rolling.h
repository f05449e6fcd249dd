/* Constraints of <joint>s that couple rotation and translation: screws, and rolling on a plane. */
#pragma once

#include "read/space/joint_ends.h"

/* Returns the constraint of a screw in m, 0 if `to` has advanced by the pitch per revolution along z of `from`. */
Node thread_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to);

/* Returns its derivative along z where it is 0: 1, or -1 half a revolution from aligned x axes. */
Node slope_of_thread(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to);

/* True if `to` rotates, so that it can roll; reports an error otherwise. */
bool can_roll(struct Reader *reader, xmlNodePtr node, const struct JointEnd *to);

/* Returns the height of the lowest point of a wheel or sphere above the plane z = 0 of `from`, in m. */
Node height_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to);

/* Returns the velocity of that point of `to` relative to `from`, along an axis of `from`, in m/s. */
Node slip_of(struct Reader *reader, xmlNodePtr node, const struct JointEnd *from, const struct JointEnd *to, int axis);
