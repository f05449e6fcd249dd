/* Forces F of contacts at rest: accelerations a = free + S F with a >= 0, F >= 0 and F^T a = 0. */
#ifndef RESTING_FORCES_H
#define RESTING_FORCES_H

#include <stdbool.h>
#include <stddef.h>

/* The problem, with S by rows, scaled to a diagonal of 1. */
struct RestingForces {
  size_t count;
  double *s, *free;
  double *found, *found_force; /* accelerations and forces of the first solution */
  double *force, *motion;      /* of the present trial: forces, accelerations */
  double *work;
  size_t *group, group_count; /* contacts that act on each other, but not on those of other groups */
};

/* Ordered from best to worst. */
enum RestingSolutions { ONE_MOTION, PERHAPS_OTHERS, SEVERAL_MOTIONS, PERHAPS_NONE, NO_MOTION };

/* Forces and accelerations below this fraction of the largest free acceleration may be rounding errors. */
static const double rounded_force = 1e-9;

size_t resting_forces_bytes(size_t count);

/* Divides a block of resting_forces_bytes() among the parts. */
struct RestingForces resting_forces_in(void *block, size_t count);

double largest_free_acceleration(const struct RestingForces *resting);

/*
 * Determines whether the motion exists and is unique; stores the first solution in found unless the present forces are
 * one (is_solved). Among up to 12 contacts of a group all solutions are found. Among more it is the one of Lemke's
 * method, and whether it certainly is the only one.
 */
enum RestingSolutions resting_forces_solve(struct RestingForces *resting, bool is_solved);

#endif
