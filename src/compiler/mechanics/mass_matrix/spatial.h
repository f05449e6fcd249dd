/* Motions, forces and inertias of frames in space, of six components each: those of the origin, and those of turning. */
#pragma once

#include "model/kinematics.h"

/* A velocity or acceleration (m/s, rad/s, ...) of a frame's origin and of its turning, or a force (N) and its moment (N.m) about the origin, along the frame's axes. */
struct SpatialVector {
  struct Vector linear, angular;
};

/* force = mass v + coupling w, moment = coupling^T v + moment w; mass and moment are symmetric. */
struct SpatialInertia {
  struct Matrix mass, coupling, moment;
};

extern const struct SpatialVector spatial_zero;

struct SpatialVector spatial_add(struct Graph *graph, struct SpatialVector a, struct SpatialVector b);
struct SpatialVector spatial_scale(struct Graph *graph, Node factor, struct SpatialVector a);

/* The power of a force along a motion. */
Node spatial_dot(struct Graph *graph, struct SpatialVector force, struct SpatialVector motion);

/* Of a body with its centre of mass at an offset, and a tensor about that, both along the frame's axes. */
struct SpatialInertia spatial_inertia_of_body(struct Graph *graph, Node mass, struct Vector offset,
                                              const struct Matrix *tensor);

struct SpatialInertia spatial_inertia_add(struct Graph *graph, const struct SpatialInertia *a,
                                          const struct SpatialInertia *b);

/* The inertia less the product gain force^T, which is symmetric. */
struct SpatialInertia spatial_inertia_less(struct Graph *graph, const struct SpatialInertia *inertia,
                                           struct SpatialVector gain, struct SpatialVector force);

/* The force that a motion takes. */
struct SpatialVector spatial_inertia_apply(struct Graph *graph, const struct SpatialInertia *inertia,
                                           struct SpatialVector motion);

/* From a frame to the one in which it has the pose, about that one's origin and along its axes. */
struct SpatialInertia spatial_inertia_to_parent(struct Graph *graph, const struct Pose *pose,
                                                const struct SpatialInertia *inertia);
struct SpatialVector spatial_force_to_parent(struct Graph *graph, const struct Pose *pose, struct SpatialVector force);

/* What a motion of the outer frame is for the one that has the pose in it. */
struct SpatialVector spatial_motion_from_parent(struct Graph *graph, const struct Pose *pose,
                                                struct SpatialVector motion);
