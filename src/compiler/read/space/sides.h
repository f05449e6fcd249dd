/* What an element between two places joins: anything in a frame with the frame's axes. */
#pragma once

#include "read/context/attributes.h"

struct Side {
  struct Vector position; /* along the base's axes */
  struct Matrix rotation;
  bool has_axes; /* of its own: no particle in the plane, which has the base's */
  size_t frame;  /* among the model's, whose axes these are */
};

/* What the attribute names, as a function of displacements too; false after reporting that there is no such thing. */
bool read_displaced_side(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side);

/* The same where nothing is displaced. */
bool read_side(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side);

/* The same while definitions are read, of what is in a frame; else the base's axes. False while its place is waited for. */
bool read_side_early(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side);

/* Its angular velocity along the base's axes. */
struct Vector angular_velocity_of_side(struct Reader *reader, xmlNodePtr node, const struct Side *side);

/* One of its axes: 0 for x, .... */
struct Vector axis_of_side(const struct Side *side, int axis);

/* The product of an axis of one side and one of the other, 0 where they are perpendicular. */
Node product_of_axes(struct Graph *graph, const struct Side *from, int first, const struct Side *to, int second);

/* Where `to` is along an axis of `from`. */
Node place_along(struct Graph *graph, const struct Side *from, const struct Side *to, int axis);
