/*
 * Two boxes along their 15 separating axes: normals of faces, and common perpendiculars of two edges. The boxes are
 * apart if their shadows on one of these axes are apart.
 *
 * S. Gottschalk, M. C. Lin, D. Manocha: OBBTree, 1996.
 */
#pragma once

#include "read/shapes/shape_pair.h"

/* A box, in vectors along the base's axes. */
struct Box {
  struct Vector centre, axis[3];
  Node half[3];  /* m, half of the size along each axis */
  Node other[3]; /* m, the centre of the other box, seen from this one's along its axes */
};

/*
 * The face of the other box with the largest distance from a box. Modes give the axis of its normal: the third one if
 * is_third, else the first one if is_first.
 */
struct BoxFace {
  Node is_first, is_third;
  Node side[3];  /* the signs of the centre of the own box, seen from the other's */
  Node distance; /* m */
};

/* Edges along axis i of the first box and j of the second. The sine of their angle is the length of the product. */
struct BoxCrossing {
  int axis[2];
  Node cosine, squared_sine;
  Node is_skew;          /* positive where the edges are not nearly parallel */
  Node inverse;          /* of the sine */
  Node outward;          /* the sign for which the product of both axes points to the first box */
  Node height;           /* m, the distance of the centres along the perpendicular, times the sine */
  struct Vector product; /* of both axes, towards the first box */
  Node distance;         /* m, of the boxes along the perpendicular */
};

struct Boxes {
  const struct ShapePair *pair;
  struct Graph *graph;
  struct Box box[2];
  Node cosine[3][3], size[3][3]; /* products of an axis of the first and an axis of the second box; without sign */
  Node least;                    /* m, the smallest half size */
  Node parallel;                 /* the squared sine below which edges count as parallel */
  Node is_close;                 /* positive where no face separates the boxes by more than a small distance */
  struct BoxFace face[2];
  struct BoxCrossing crossing[3][3];
  Node distance; /* m, of the boxes along the separating axis */
};

/* Finds the axes and the distance of two boxes. */
struct Boxes boxes_of(const struct ShapePair *pair);

/* Returns the cosine of axis i of a box and axis k of the other one. own: the index of the former. */
Node cosine_of_axes(const struct Boxes *boxes, int own, int i, int k);

/* Returns the mode of a switching function: 1 where it is positive, or where it does not matter and has no events. */
Node is_positive_where(const struct Boxes *boxes, Node matters, Node value);

/* Returns the sign of a value with a size, without 0. */
Node sign_where(const struct Boxes *boxes, Node matters, Node value, Node size);

/* Returns the value of the three that belongs to the axis of a face. */
Node along_face(const struct Boxes *boxes, const struct BoxFace *face, Node first, Node second, Node third);

/* Returns the difference of two squares, which is positive where a coordinate is between -reach and reach. */
Node margin_within(const struct Boxes *boxes, Node reach, Node coordinate);
