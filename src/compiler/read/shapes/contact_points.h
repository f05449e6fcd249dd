/* Contact points of pairs of shapes, in closed form. */
#pragma once

#include "read/shapes/shape_pair.h"

/* Returns a shape with its pose. line: for messages about displacements. */
struct ContactSide contact_side_of(struct Reader *reader, long line, const struct ContactShape *shape);

/*
 * Returns the number of contact points of two shapes, 0 if there is no closed form. May be called before the shapes are
 * placed, but after the corners of meshes are found.
 */
size_t count_contact_points(const struct ContactShape *first, const struct ContactShape *second);

/* Returns the contact points, count_contact_points() of them, for rigid or compliant contacts. */
struct ContactPoints contact_points_of(struct Reader *reader, long line, const struct ContactSide *first,
                                       const struct ContactSide *second, bool is_rigid);
