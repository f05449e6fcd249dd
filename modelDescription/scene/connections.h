/* Finds rods and joints between objects, kept by formulas or by constraints. */
#pragma once

#include "sampled_positions.h"

/* Constraint forces in a planar joint, and coordinates of its point on both objects. */
enum { FORCES = 2, JOINT_COORDINATES = 4 };

/* Two objects at constant distance. Its compressive force, in N, is factor times the force of the constraint. */
struct Rod {
  size_t from, to; /* indices of objects; from may be the base */
  double length;
  size_t constraint; /* index in the model, if has_force */
  bool has_force;
  double factor;
};

/* A point that a planar body shares with another object, and the constraint forces on the body there. */
struct SceneJoint {
  size_t of, with;
  /* m: x, y along the body's axes; then x, y along those of the other planar body, or from another object */
  double coordinates[JOINT_COORDINATES];
  size_t force_count;
  size_t constraints[FORCES]; /* indices in the model */
  double along[FORCES][2];    /* N along x and y for a constraint force of 1 */
};

/* The rods and joints that were found. The caller owns the lists. */
struct Connections {
  struct Rod *rods;
  size_t rod_count;
  struct SceneJoint *joints;
  size_t joint_count;
};

/* Finds the shared point of joint->of, a planar body, and joint->with, and its forces. False if there is none. */
bool find_joint(const struct SampledPositions *samples, struct SceneJoint *joint);

/* Finds all rods and joints. */
struct Connections find_connections(const struct SampledPositions *samples);
