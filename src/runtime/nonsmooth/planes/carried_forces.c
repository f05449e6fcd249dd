/*
 * Frictions and contacts can carry a given force beside that of their constraint. A <constraint> cannot. Where one holds
 * the same bodies, as a rod does, it takes a part of what was found. For the norm of all constraint forces is least. So
 * the frictions carry other loads c, with which their forces f are as found. With the orthogonal projector P onto the
 * forces that share a load,
 *
 *   f(c) = f(0) + (1 - P) c.
 *
 * The matrix is symmetric and positive semidefinite, and need not be known. The method of conjugate gradients needs one
 * evaluation of the accelerations a step, and at most as many steps as there are rows (M. R. Hestenes, E. Stiefel:
 * Methods of conjugate gradients for solving linear systems, Journal of Research of the NBS 49, 1952).
 */
#include "nonsmooth/planes/carried_forces.h"

#include <math.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/planes/lines_at_rest.h"

/* Lets the friction of a row stick with its load. */
static void carry(struct RestForces *forces, size_t row) {
  if (row_is_of_line(forces, row)) {
    double kinetic = rest_forces_kinetic(forces, row);
    line_carry(forces->resolution, forces->impulses.member[row], kinetic > 0.0 ? forces->load[row] / kinetic : 0.0);
    return;
  }
  struct PlaneState state = state_of_row(forces, row);
  state.sliding = rest_forces_kinetic(forces, row);
  plane_carry(forces->resolution, &state, &forces->load[row]);
}

/* Keeps the force that a friction carries, without its constraint. */
static void release(struct RestForces *forces, size_t row) {
  size_t friction = forces->impulses.member[row];
  if (row_is_of_line(forces, row)) {
    line_release(forces->resolution, friction, carried_share(forces->resolution->instance, friction));
    return;
  }
  struct PlaneState state = state_of_row(forces, row);
  plane_release(forces->resolution, &state);
}

/* Returns a component of the force of a friction that sticks. */
static double force_of_row(const struct RestForces *forces, size_t row) {
  if (row_is_of_line(forces, row)) return force_on_line(forces->resolution, forces->impulses.member[row]);
  size_t side = (row - forces->impulses.contact_count) % 2;
  return state_of_row(forces, row - side).force[side];
}

/* Lets the frictions carry what was found without their constraints, then the contacts what balances it. */
static bool let_contacts_carry(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  for (size_t row = forces->impulses.contact_count; row < forces->n; row += rows_of_friction(forces, row)) {
    if (rest_slips(forces, row)) continue;
    for (size_t i = row; i < row + rows_of_friction(forces, row); i++) forces->load[i] = -forces->force[i];
    carry(forces, row);
    release(forces, row);
  }
  if (!plane_evaluate(resolution)) return false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (contact_is_closed(resolution, i)) contact_carry(resolution, i, contact_force(resolution, i));
  return true;
}

/* Evaluates the forces with the loads. Fills what they miss of those found. False if accelerations do not exist. */
static bool find_missing(struct RestForces *forces, double *missing) {
  for (size_t row = forces->impulses.contact_count; row < forces->n; row += rows_of_friction(forces, row))
    if (!rest_slips(forces, row)) carry(forces, row);
  if (!plane_evaluate(forces->resolution)) return false;
  for (size_t row = forces->impulses.contact_count; row < forces->n; row++)
    missing[row] = rest_slips(forces, row) ? 0.0 : -forces->force[row] - force_of_row(forces, row);
  return true;
}

static double product_of(const struct RestForces *forces, const double *a, const double *b) {
  double sum = 0.0;
  for (size_t row = forces->impulses.contact_count; row < forces->n; row++) sum += a[row] * b[row];
  return sum;
}

/* Adds share times b to a. */
static void add(const struct RestForces *forces, double *a, double share, const double *b) {
  for (size_t row = forces->impulses.contact_count; row < forces->n; row++) a[row] += share * b[row];
}

/* Changes the loads until nothing is missing, as long as each step leaves less. Returns what is; NAN on failure. */
static double correct_loads(struct RestForces *forces, double rounding) {
  size_t n = forces->n;
  double *missing = forces->missing, *way = missing + n, *next = way + n;
  if (!find_missing(forces, missing)) return NAN;
  double square = product_of(forces, missing, missing);
  for (size_t row = 0; row < n; row++) way[row] = missing[row];
  for (size_t step = 0; step < n && sqrt(square) > rounding; step++) {
    add(forces, forces->load, 1.0, way);
    if (!find_missing(forces, next)) return NAN;
    double curvature = product_of(forces, way, missing) - product_of(forces, way, next);
    double share = curvature > 0.0 ? square / curvature : 0.0, before = square;
    add(forces, forces->load, share - 1.0, way);
    for (size_t row = forces->impulses.contact_count; row < forces->n; row++)
      missing[row] += share * (next[row] - missing[row]);
    square = product_of(forces, missing, missing);
    if (!(square < before)) break;
    for (size_t row = forces->impulses.contact_count; row < forces->n; row++)
      way[row] = missing[row] + square / before * way[row];
  }
  return find_missing(forces, missing) ? sqrt(product_of(forces, missing, missing)) : NAN;
}

bool carried_forces_take(struct RestForces *forces) {
  double rounding = share_at_limit * largest_stiction(forces->resolution), size = INFINITY, before;
  if (!let_contacts_carry(forces)) return false;
  /* The friction of a contact that has a part of the load is not linear in the loads. */
  do {
    before = size;
    size = correct_loads(forces, rounding);
  } while (size > rounding && size < 0.5 * before);
  return !isnan(size);
}
