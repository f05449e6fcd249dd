/* Constraints of <joint>s in which turning goes with moving: a screw's thread, and what rolls on a plane. */
#pragma once

#include "read/space/sides.h"

/* In m; 0 where `to` has moved along the z axis of `from` by the pitch for each turn. */
Node thread_of(struct Reader *reader, xmlNodePtr node, const struct Side *from, const struct Side *to);

/* Its slope along z where it is 0: 1, or -1 half a turn from where the x axes meet. */
Node slope_of_thread(struct Reader *reader, xmlNodePtr node, const struct Side *from, const struct Side *to);

/* Whether `to` turns, so that it may roll; reports where it does not. */
bool can_roll(struct Reader *reader, xmlNodePtr node, const struct Side *to);

/* How high the lowest point of a wheel or sphere is above the plane z = 0 of `from`. */
Node height_of(struct Reader *reader, xmlNodePtr node, const struct Side *from, const struct Side *to);

/* How fast what is there of `to` slips over what is there of `from`, along an axis of `from`. */
Node slip_of(struct Reader *reader, xmlNodePtr node, const struct Side *from, const struct Side *to, int axis);
