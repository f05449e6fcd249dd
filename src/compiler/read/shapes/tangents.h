/* Tangents and slip velocities of contacts between shapes. */
#pragma once

#include "read/shapes/contact_points.h"

/*
 * Components, in m/s, of the first shape's velocity relative to the second, along two orthogonal tangents. On a plane
 * these are its other two axes. Otherwise they are two constant orthogonal vectors, rotated by the shortest rotation
 * from the third vector to the normal. That rotation is undefined if the normal is opposite to the third vector.
 */
struct Slip {
  Node along, across;
};

/* Returns the slip velocity of two shapes at a contact point. */
struct Slip slip_of_contact(struct Reader *reader, const struct ContactSide *first, const struct ContactSide *second,
                            const struct ContactPoint *point);
