/*
 * Spatial vectors and inertias: motions, forces and inertias of frames, with a linear and an angular part (R.
 * Featherstone: Rigid Body Dynamics Algorithms, 2008, chapter 2).
 */
#pragma once

#include "model/kinematics.h"

/*
 * A spatial vector along a frame's axes. It is a velocity or acceleration of the origin (m/s, m/s2) and of the
 * rotation (rad/s, rad/s2), or a force (N) with its moment (N.m).
 */
struct SpatialVector {
  struct Vector linear, angular;
};

/* force = mass v + coupling omega, moment = coupling^T v + moment omega; mass and moment are symmetric. */
struct SpatialInertia {
  struct Matrix mass, coupling, moment;
};

extern const struct SpatialVector spatial_zero;

struct SpatialVector spatial_add(struct Graph *graph, struct SpatialVector a, struct SpatialVector b);
struct SpatialVector spatial_scale(struct Graph *graph, Node factor, struct SpatialVector a);

/* Returns the power of a force along a motion. */
Node spatial_dot(struct Graph *graph, struct SpatialVector force, struct SpatialVector motion);

/* Returns the inertia of a body: offset of its centre of mass, and tensor about that, along the frame's axes. */
struct SpatialInertia spatial_inertia_of_body(struct Graph *graph, Node mass, struct Vector offset,
                                              const struct Matrix *tensor);

struct SpatialInertia spatial_inertia_add(struct Graph *graph, const struct SpatialInertia *a,
                                          const struct SpatialInertia *b);

/* Returns inertia - gain force^T, which must be symmetric. */
struct SpatialInertia spatial_inertia_subtract(struct Graph *graph, const struct SpatialInertia *inertia,
                                               struct SpatialVector gain, struct SpatialVector force);

/* Returns the force that gives a motion to the inertia. */
struct SpatialVector spatial_inertia_apply(struct Graph *graph, const struct SpatialInertia *inertia,
                                           struct SpatialVector motion);

/* Return an inertia or a force in the parent frame, about its origin; pose is that of the frame in it. */
struct SpatialInertia spatial_inertia_to_parent(struct Graph *graph, const struct Pose *pose,
                                                const struct SpatialInertia *inertia);
struct SpatialVector spatial_force_to_parent(struct Graph *graph, const struct Pose *pose, struct SpatialVector force);

/* Returns a motion of the parent frame as one of the frame with this pose in it. */
struct SpatialVector spatial_motion_from_parent(struct Graph *graph, const struct Pose *pose,
                                                struct SpatialVector motion);
