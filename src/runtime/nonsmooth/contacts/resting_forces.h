/* Forces F of contacts at rest: accelerations a = free + S F with a >= 0, F >= 0 and F^T a = 0. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct ConePath;

/* The problem, with S by rows; it is scaled such that its diagonal is 1 without friction. */
struct RestingForces {
  size_t count;
  const struct ConePath *path; /* of the switch table */
  double *s, *free;
  double *present;             /* the present forces; 0 for open contacts */
  double *found, *found_force; /* accelerations and forces of the first solution */
  double *force, *motion;      /* of the present trial: forces, accelerations */
  double *presses;             /* of each contact of the group: 1 if it presses, else 0 */
  double *work;
  size_t *group, group_count; /* rows coupled by S with each other, but with no others */
};

/*
 * Ordered from best to worst. ONE_MOTION: the only one, or that to which compliance leads from the present forces.
 * PERHAPS_OTHERS: one was found. OTHER_MOTION: compliance leads from the present one to another. NO_MOTION: none was found.
 */
enum RestingSolutions { ONE_MOTION, PERHAPS_OTHERS, OTHER_MOTION, NO_MOTION };

/* Forces and accelerations below this fraction of the largest free acceleration may be rounding errors. */
static const double rounded_force = 1e-9;

/* Returns the bytes of a problem with this number of contacts. */
size_t resting_forces_bytes(const struct ConePath *path, size_t count);

/* Divides a block of resting_forces_bytes() among the parts. */
struct RestingForces resting_forces_in(void *block, const struct ConePath *path, size_t count);

/* Returns the largest magnitude of the free accelerations. */
double largest_free_acceleration(const struct RestingForces *resting);

/*
 * Finds the forces of contacts without sliding friction, and stores the solution in found and found_force. Those times
 * `unit` have the least norm. False if there is none, as where prescribed motions close a gap.
 */
bool resting_forces_press(struct RestingForces *resting, const double *unit);

/*
 * Finds the forces. is_solved: the present ones are a solution. They are kept if there is no other solution, or if they
 * are stable under compliance. Else a solution is stored in found and found_force.
 */
enum RestingSolutions resting_forces_solve(struct RestingForces *resting, bool is_solved);
