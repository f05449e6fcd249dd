/* Points at which shapes touch planes: the second shape of the pair is a plane. */
#pragma once

#include "read/shapes/shape_pair.h"

/* Returns the number of contact points of a shape on a plane; 0 for a mesh whose corners are not found yet. */
size_t count_points_on_plane(const struct ContactShape *shape);

/* Appends the first shape's points, which are fixed in its frame. */
void plane_contacts(const struct ShapePair *pair, struct ContactPoints *contacts);

/* The same for a cylinder: it stands on points of its ends, and rolls on the lowest points of its rims. */
void rim_contacts(const struct ShapePair *pair, struct ContactPoints *contacts);

/* Appends the lowest point of the first shape, an ellipsoid. */
void ellipsoid_contact(const struct ShapePair *pair, struct ContactPoints *contacts);
