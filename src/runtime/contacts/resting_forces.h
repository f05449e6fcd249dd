/* The forces F of contacts at rest, such that their accelerations are a = free + S F >= 0, F >= 0 and F a = 0. */
#ifndef RESTING_FORCES_H
#define RESTING_FORCES_H

#include <stdbool.h>
#include <stddef.h>

/* Numbers of rows of S by rows; in units in which the mobility of each contact by itself is 1. */
struct RestingForces {
  size_t count;
  double *s, *free;
  double *found, *found_force; /* the accelerations and forces of the first solution */
  double *force, *motion;      /* of what is tried out, and its accelerations */
  double *work;
  size_t *group, group_count; /* contacts that act on one another, but not on others */
};

/* From best to worst. */
enum RestingSolutions { ONE_MOTION, PERHAPS_OTHERS, SEVERAL_MOTIONS, PERHAPS_NONE, NO_MOTION };

/* Forces and accelerations below this share of the largest free acceleration may be rounding. */
static const double rounded_force = 1e-9;

size_t resting_forces_bytes(size_t count);

/* Where all of it is in a block of so many bytes. */
struct RestingForces resting_forces_in(void *block, size_t count);

double largest_free_acceleration(const struct RestingForces *resting);

/*
 * How many motions there are, and into *found the first, unless the present forces are a solution. All are looked for among
 * up to 12 contacts that act on one another; among more, that which Lemke's method comes to, and whether it is surely the
 * only one.
 */
enum RestingSolutions resting_forces_solve(struct RestingForces *resting, bool is_solved);

#endif
