/* Two shapes that may touch, and the points at which they do. */
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
  Node are_near;                     /* positive where the shapes may touch; ONE everywhere: see reach.h */
  const struct ContactSide *carrier; /* NULL if the points move in both frames */
  struct Vector below;               /* m, from the centres to the points, along the base's axes */
};

/* Two shapes, with the graph and scope for expressions of their contacts. */
struct ShapePair {
  struct Scope *scope;
  struct Graph *graph;
  long line;
  const struct ContactSide *first, *second;
  bool is_rigid;
};

/* Returns a vector of a length along the axis of a shape, in the shape's axes. */
struct Vector along_axis(const struct ContactShape *shape, Node length);

/* Rotates a vector along the axes of the shape to the base's axes. */
struct Vector rotated_by(const struct ShapePair *pair, const struct ContactSide *side, struct Vector vector);

/* Rotates a vector along the base's axes to those of the shape. */
struct Vector seen_by(const struct ShapePair *pair, const struct ContactSide *side, struct Vector vector);

/* Returns axis i of the shape's own frame, such as of a box, along the base's axes. */
struct Vector own_axis_of(const struct ShapePair *pair, const struct ContactSide *side, int i);

/* Return the axis and the centre of a shape, along the base's axes. */
struct Vector axis_of(const struct ShapePair *pair, const struct ContactSide *side);
struct Vector middle_of(const struct ShapePair *pair, const struct ContactSide *side);

/* Notes where the points are in the frame of the first shape, which carries them. */
void carry_by_first(const struct ShapePair *pair, struct ContactPoints *contacts);
