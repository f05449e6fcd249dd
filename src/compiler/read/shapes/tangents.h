/* Along which shapes slide where they touch. */
#pragma once

#include "read/shapes/touches.h"

/*
 * The components, in m/s, of the velocity of the first shape's material against the second's, along two tangents at right
 * angles. Against a plane these are its other two axes. Of other shapes they are two constant axes, turned as the shortest turn
 * brings the third to the normal: there is none where the normal is opposite to the third.
 */
struct Slip {
  Node along, across;
};

struct Slip slip_of_touch(struct Reader *reader, const struct Side *first, const struct Side *second,
                          const struct Touch *touch);
