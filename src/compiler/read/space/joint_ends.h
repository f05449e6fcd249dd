/* The ends of a joint, spring, bushing or the like: a point, body or frame, with the axes of its frame. */
#pragma once

#include "read/context/attributes.h"

struct JointEnd {
  struct Vector position; /* m, along the base's axes */
  struct Matrix rotation;
  bool has_axes; /* false for a particle in the plane, which has the base's axes */
  size_t frame;  /* index into the model's frames of the frame with these axes */
};

/* Reads the end that an attribute names, as a function of displacements. Returns false after reporting an error. */
bool read_displaced_joint_end(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end);

/* Like read_displaced_joint_end(), at zero displacements. */
bool read_joint_end(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end);

/*
 * Like read_joint_end(), while definitions are parsed. Anything that is not in a frame gets the base's axes. Returns
 * false if the current definition waits for it.
 */
bool read_joint_end_early(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end);

/* Returns the angular velocity of an end along the base's axes. */
struct Vector angular_velocity_of_end(struct Reader *reader, xmlNodePtr node, const struct JointEnd *end);

/* Returns an axis as a unit vector along the base's axes: 0 for x, .... */
struct Vector axis_of_end(const struct JointEnd *end, int axis);

/* Returns the scalar product of an axis of one end and an axis of the other. */
Node product_of_axes(struct Graph *graph, const struct JointEnd *from, int first, const struct JointEnd *to,
                     int second);

/* Returns the position of `to` relative to `from` along an axis of `from`, in m. */
Node offset_along(struct Graph *graph, const struct JointEnd *from, const struct JointEnd *to, int axis);
