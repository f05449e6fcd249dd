/*
 * Frames: axes that are translated and rotated step by step, and their velocities. Elements of vectors and matrices are
 * nodes. Quantities of a moving frame have components along its own axes. This keeps expressions short: along a chain
 * of joints, each joint adds about the same number of operations.
 */
#pragma once

#include "algebra/graph.h"

/* "x", "y" and "z". */
extern const char *const axes[3];

/* Components along x, y and z. */
struct Vector {
  Node along[3];
};

/* A 3 x 3 matrix by rows. */
struct Matrix {
  struct Vector row[3];
};

/* Position, orientation and velocities of a frame. */
struct Pose {
  struct Matrix rotation;         /* maps components along its axes to those along the base's */
  struct Vector origin;           /* m, along the base's axes */
  struct Vector velocity;         /* of its origin, along its own axes */
  struct Vector angular_velocity; /* along its own axes */
};

struct Vector vector_add(struct Graph *graph, struct Vector a, struct Vector b);
struct Vector vector_cross(struct Graph *graph, struct Vector a, struct Vector b);
struct Vector vector_scale(struct Graph *graph, Node factor, struct Vector a);
struct Vector vector_subtract(struct Graph *graph, struct Vector a, struct Vector b);
Node vector_dot(struct Graph *graph, struct Vector a, struct Vector b);

/* Return matrix a, and matrix^T a. */
struct Vector matrix_apply(struct Graph *graph, const struct Matrix *matrix, struct Vector a);
struct Vector matrix_apply_transposed(struct Graph *graph, const struct Matrix *matrix, struct Vector a);

/* Returns the transpose, which is the inverse of a rotation matrix. */
struct Matrix matrix_transposed(const struct Matrix *matrix);

/* Returns the pose of the base. */
struct Pose pose_of_base(void);

/* Translates the frame by an offset along its own axes; rate is the offset's time derivative. */
void pose_translate(struct Graph *graph, struct Pose *pose, struct Vector offset, struct Vector rate);

/* Rotates the frame about a constant unit axis. */
void pose_rotate(struct Graph *graph, struct Pose *pose, struct Vector axis, Node angle, Node rate);

/* Rotates the frame by a unit quaternion q[0] + q[1] i + q[2] j + q[3] k. */
void pose_rotate_by_quaternion(struct Graph *graph, struct Pose *pose, const Node q[4], const Node rate[4]);

/* Applies a translation or a rotation relative to the frame. One with both would have a velocity along other axes. */
void pose_follow(struct Graph *graph, struct Pose *pose, const struct Pose *step);

/* Returns the velocity of a point of the frame, along its axes; rate is the offset's time derivative. */
struct Vector velocity_at(struct Graph *graph, const struct Pose *pose, struct Vector offset, struct Vector rate);

/* Returns the position of a point of the frame, along the base's axes. */
struct Vector position_at(struct Graph *graph, const struct Pose *pose, struct Vector offset);
