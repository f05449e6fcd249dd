/*
 * Frames: axes that are moved and turned step by step, and how fast they move by that. Vectors and matrices are of
 * nodes; what belongs to a moving frame is along its own axes, which keeps expressions short: along a chain of joints
 * each one adds as much as the one before.
 */
#pragma once

#include "algebra/graph.h"

/* "x", "y" and "z". */
extern const char *const axes[3];

struct Vector {
  Node along[3];
};

/* Rows of a 3 x 3 matrix. */
struct Matrix {
  struct Vector row[3];
};

/* Where a frame is and how it moves. */
struct Pose {
  struct Matrix rotation;         /* turns components along its axes into those along the base's */
  struct Vector origin;           /* m, along the base's axes */
  struct Vector velocity;         /* of its origin, along its own axes */
  struct Vector angular_velocity; /* along its own axes */
};

struct Vector vector_add(struct Graph *graph, struct Vector a, struct Vector b);
struct Vector vector_cross(struct Graph *graph, struct Vector a, struct Vector b);
struct Vector vector_scale(struct Graph *graph, Node factor, struct Vector a);
struct Vector vector_subtract(struct Graph *graph, struct Vector a, struct Vector b);
Node vector_dot(struct Graph *graph, struct Vector a, struct Vector b);

/* matrix a, and with the transposed matrix. */
struct Vector matrix_apply(struct Graph *graph, const struct Matrix *matrix, struct Vector a);
struct Vector matrix_apply_transposed(struct Graph *graph, const struct Matrix *matrix, struct Vector a);

struct Matrix matrix_transposed(const struct Matrix *matrix);

/* The pose of the base. */
struct Pose pose_of_base(void);

/* Moves the frame by an offset along its own axes; rate: the offset's time derivative. */
void pose_translate(struct Graph *graph, struct Pose *pose, struct Vector offset, struct Vector rate);

/* Turns the frame about a constant axis of length 1. */
void pose_turn(struct Graph *graph, struct Pose *pose, struct Vector axis, Node angle, Node rate);

/* Turns it by a quaternion of norm 1, q[0] + q[1] i + q[2] j + q[3] k. */
void pose_turn_by_quaternion(struct Graph *graph, struct Pose *pose, const Node q[4], const Node rate[4]);

/* Moves or turns the frame by a step, as seen from itself; one that does both would tell its velocity along axes of its own. */
void pose_follow(struct Graph *graph, struct Pose *pose, const struct Pose *step);

/* The velocity of a point of the frame at an offset, along its axes. */
struct Vector velocity_at(struct Graph *graph, const struct Pose *pose, struct Vector offset, struct Vector rate);

/* The place of such a point, along the base's axes. */
struct Vector position_at(struct Graph *graph, const struct Pose *pose, struct Vector offset);
