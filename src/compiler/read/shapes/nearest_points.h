/* Nearest points of two shapes, of which the first one is a ball, or consists of balls. */
#pragma once

#include "read/shapes/shape_pair.h"

/* Append the contact of a sphere with a sphere, box, cylinder or capsule. */
void sphere_contact(const struct ShapePair *pair, struct ContactPoints *contacts);
void box_contact(const struct ShapePair *pair, struct ContactPoints *contacts);
void cylinder_contact(const struct ShapePair *pair, struct ContactPoints *contacts);
void capsule_contact(const struct ShapePair *pair, struct ContactPoints *contacts);

/* Appends the contact of two capsules. */
void capsules_contact(const struct ShapePair *pair, struct ContactPoints *contacts);

/* Appends the contacts of a capsule with a box: those of its two ends, then those of its axis with each edge. */
void capsule_on_box_contacts(const struct ShapePair *pair, struct ContactPoints *contacts);
size_t count_points_of_capsule_on_box(const struct ContactShape *box);
