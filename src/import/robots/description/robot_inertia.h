/* The velocities of a robot and its mass matrix, with all joints as placed. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/diagnostics.h"
#include "robots/description/robot.h"

/* One velocity of a joint in the world. A rotation is about an axis through the point. */
struct Velocity {
  double axis[3], point[3];
  bool rotates;
  double armature;
  size_t previous; /* the velocity before it on the way to the world, and 1; 0 for none */
};

/* The velocities of a file, and for each link its placement in the world and its last velocity, and 1. */
struct Velocities {
  struct Velocity *items;
  size_t count;
  struct Placement *placements;
  size_t *last;
};

/* Returns the index of the link of this name; the number of links if there is none. */
size_t robot_link_index(const struct Robot *robot, const char *name);

/* Returns the placement of the child of a joint in its parent at the start. */
struct Placement placement_at_start(const struct RobotJoint *joint);

/* Sets the velocity in the world of a point of a body that moves with this velocity. */
void robot_velocity_at(const struct Velocity *velocity, const double point[3], double result[3]);

/* The velocities, and the Cholesky factor of the mass matrix; NULL before robot_find_inertia(). */
struct Inertia {
  struct Velocities all;
  double *factor;
};

/*
 * Finds the inertia if it is not yet known. Returns false after reporting a tendon with armature, whose inertia is not
 * computed. what: needs the inertia; remedy: completes "expected ... in its place".
 */
bool robot_find_inertia(const struct Robot *robot, struct Inertia *inertia, struct Diagnostics *diagnostics, long line,
                        const char *what, const char *remedy);

/*
 * Returns 1/(m^T M^-1 m) for the mass matrix M and the moments m, one for each velocity. It is the inertia that a force
 * with these moments moves while all joints move freely. Not finite without moments, or for a joint without inertia.
 */
double robot_reflected_inertia(const struct Inertia *inertia, const double *moments);
