/* Nearest points of pairs of shapes, in closed form. */
#pragma once

#include "read/context/attributes.h"

/* A point of possible contact, in vectors along the base's axes. */
struct ContactPoint {
  struct Vector point;  /* m */
  struct Vector normal; /* unit normal, pointing to the first shape */
  Node gap;             /* m, negative if the shapes overlap */
  Node distance;        /* m, from the centre of a ball to the other shape: without a normal at 0; ZERO for planes */
  struct Vector offset; /* m, of the centre along the carrier's axes, if there is a carrier */
};

/* A shape with its pose, at zero displacements. */
struct ContactSide {
  const struct ContactShape *shape;
  struct Pose pose; /* of the shape's frame or particle */
};

/* Points of a shape on a plane are those of balls whose centres are fixed in the shape's frame, its carrier. */
struct ContactPoints {
  struct ContactPoint *items;
  size_t count;
  const struct ContactSide *carrier; /* NULL if the points move in both frames */
  struct Vector below;               /* m, from the centres to the points, along the base's axes */
};

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
