/*
 * Impulses p of an impact with Coulomb friction cones, by Newton's law of restitution. With the rates u = rate + W p:
 *
 *   contact:   u >= 0,  p >= 0,  u p = 0,
 *   friction:  |p| <= mu p_contact,  and  p = -mu p_contact u / |u|  where u is not 0.
 *
 * Projected block Gauss-Seidel sweeps come near a solution: each impulse in turn is projected with the others fixed.
 * A sweep costs O(n^2). From there a semismooth Newton method is tried (cone_newton.c). A trial that does not converge
 * continues the sweeps, LAW_SWEEPS more than the last time. After LAW_TRIALS an interior-point method searches
 * (cone_interior.c).
 *
 * The search fails if the best residual is larger than law_roughly_holds and than the rounding error of the rates.
 * Friction that presses a contact together may leave no solution (Painleve's paradox).
 *
 * For plane_forces.c the same conditions hold between forces and accelerations at rest.
 */
#include "nonsmooth/planes/cone_impulses.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/impacts.h"
#include "nonsmooth/contacts/planes.h"
#include "evaluation/services.h"
#include "nonsmooth/planes/cone_interior.h"
#include "nonsmooth/planes/cone_newton.h"

/* Trials; those from each start in the search for other impulses. */
enum { LAW_TRIALS = 4, OTHER_LAW_TRIALS = 2 };

/* Sweeps of the first trial, and how many more each further trial makes. */
enum { LAW_SWEEPS = 10 };

/*
 * Residuals relative to the largest impulse, as rates. law_holds ends a search. Rounding leaves up to law_nearly_holds
 * where sticking frictions are at their limits or impulses are small beside rates. law_roughly_holds is accepted at
 * last.
 */
static const double law_holds = 1e-12, law_nearly_holds = 1e-9, law_roughly_holds = 1e-5;

/* Directions of the friction impulses at which the search for other impulses starts. */
static const double start_directions[][2] = {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};

static void update_contact_impulse(struct Cones *cones, size_t row) {
  cones->impulse[row] = fmax(cones->impulse[row] - cones_rate_behind(cones, row) / cones->scale[row], 0.0);
}

static void update_friction_impulse(struct Cones *cones, size_t row, size_t rows) {
  double whole[2] = {0.0, 0.0}, limit = fmax(cones_limit(cones, row), 0.0);
  if (!(cones->scale[row] > 0.0)) return;
  for (size_t i = 0; i < rows; i++)
    whole[i] = cones->impulse[row + i] - cones_rate_behind(cones, row + i) / cones->scale[row];
  double size = hypot(whole[0], whole[1]), share = size > limit ? limit / size : 1.0;
  for (size_t i = 0; i < rows; i++) cones->impulse[row + i] = share * whole[i];
}

static void sweep_contacts(struct Cones *cones) {
  for (size_t row = 0; row < cones->impulses->count;) {
    size_t rows = cones_row_count(cones, row);
    if (row < cones->impulses->contact_count) update_contact_impulse(cones, row);
    else update_friction_impulse(cones, row, rows);
    row += rows;
  }
}

/* Returns W_ii of a row; in a plane the larger eigenvalue of its 2 x 2 block. */
static double scale_of_impulse(const struct Cones *cones, size_t row, size_t rows) {
  size_t n = cones->impulses->count;
  const double *m = &cones->impulses->delassus[row * n + row];
  double scale = m[0];
  if (rows == 2) scale = 0.5 * (m[0] + m[n + 1]) + hypot(0.5 * (m[0] - m[n + 1]), 0.5 * (m[1] + m[n]));
  return scale > DBL_MIN ? scale : 0.0;
}

/* Fills the scales. False if a contact cannot be moved. */
static bool fill_scales(struct Cones *cones) {
  bool moves = true;
  for (size_t row = 0; row < cones->impulses->count;) {
    size_t rows = cones_row_count(cones, row);
    for (size_t i = 0; i < rows; i++) cones->scale[row + i] = scale_of_impulse(cones, row, rows);
    moves &= row >= cones->impulses->contact_count || cones->scale[row] > 0.0;
    row += rows;
  }
  return moves;
}

/*
 * Makes trials, each with sweeps from where the sweeps before ended (first from swept), then Newton's method. Leaves
 * the best impulses in cones->impulse, and returns their relative residual.
 */
static double come_to_law(struct Cones *cones, int trials, double *best, double *swept, double *work) {
  size_t bytes = cones->impulses->count * sizeof(double);
  double least = INFINITY;
  for (int trial = 0; trial < trials && !(least <= law_holds); trial++) {
    memcpy(cones->impulse, swept, bytes);
    for (int count = 0; count < LAW_SWEEPS * (trial + 1); count++) sweep_contacts(cones);
    memcpy(swept, cones->impulse, bytes);
    double miss = cones_relative_miss(cones, cone_newton(cones, work));
    if (miss < least) memcpy(best, cones->impulse, bytes);
    least = fmin(least, miss);
  }
  memcpy(cones->impulse, best, bytes);
  return least;
}

/* Takes workspace for the cones and their solvers; also for the impulses if impulse is NULL. NULL without memory. */
static double *create_cones(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                            const double *rate, double *impulse, struct Cones *cones) {
  struct Instance *instance = resolution->instance;
  size_t n = impulses->count;
  double *block = scratch_take(instance, SCRATCH_CONES, (4 * n + cone_interior_work_count(n)) * sizeof *block);
  *cones = (struct Cones){.resolution = resolution, .impulses = impulses, .rate = rate, .scale = block};
  if (block == NULL) {
    solver_is_out_of_memory(instance);
    return NULL;
  }
  cones->impulse = impulse != NULL ? impulse : block + n;
  return block + 2 * n;
}

/* True if the residual is small, or a rounding error of velocities, as in the slowest impacts. */
static bool is_accepted(struct Cones *cones, double miss, double *work) {
  return miss <= law_roughly_holds || cone_newton(cones, work) <= cones->impulses->rounding;
}

/* Finds impulses by sweeps; by an interior path if these do not converge. */
static bool fulfil_law(struct Cones *cones, double *best, double *swept, double *work) {
  double miss = come_to_law(cones, LAW_TRIALS, best, swept, work);
  if (miss <= law_holds) return true;
  memcpy(best, cones->impulse, cones->impulses->count * sizeof *best);
  double other = cone_interior(cones, law_holds, false, work);
  if (!(other < miss)) memcpy(cones->impulse, best, cones->impulses->count * sizeof *best);
  return is_accepted(cones, fmin(other, miss), work);
}

bool cone_impulses_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                        double *impulse) {
  struct Cones cones;
  size_t n = impulses->count;
  double *work = create_cones(resolution, impulses, rate, impulse, &cones);
  if (work == NULL) return false;
  bool is_done = fill_scales(&cones) && fulfil_law(&cones, work, work + n, work + 2 * n);
  scratch_return(resolution->instance, SCRATCH_CONES);
  return is_done;
}

/*
 * Finds forces by an interior path, in the middle of those that are possible; else by sweeps from no force. Returns
 * their relative residual.
 */
static double fulfil_law_of_forces(struct Cones *cones, double *best, double *swept, double *work) {
  double miss = cone_interior(cones, law_holds, true, work);
  if (miss <= law_roughly_holds) return miss;
  memset(swept, 0, cones->impulses->count * sizeof *swept);
  return come_to_law(cones, LAW_TRIALS, best, swept, work);
}

bool cone_forces_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                      double *force, double *error) {
  struct Cones cones;
  size_t n = impulses->count;
  double *work = create_cones(resolution, impulses, rate, force, &cones);
  if (work == NULL) return false;
  double miss = fill_scales(&cones) ? fulfil_law_of_forces(&cones, work, work + n, work + 2 * n) : INFINITY;
  bool is_done = miss <= law_roughly_holds;
  *error = is_done ? 2.0 * miss * cones_largest(&cones) : INFINITY;
  scratch_return(resolution->instance, SCRATCH_CONES);
  return is_done;
}

/*
 * Fills a start: one contact has the largest impulse, others none, and its frictions push to the limit in a direction.
 */
static void fill_start(struct Cones *cones, const double *found, size_t hit, const double *direction, double *start) {
  size_t contacts = cones->impulses->contact_count;
  memset(cones->impulse, 0, cones->impulses->count * sizeof *cones->impulse);
  for (size_t i = 0; i < contacts; i++) cones->impulse[hit] = fmax(cones->impulse[hit], found[i]);
  for (size_t row = contacts; row < cones->impulses->count;) {
    size_t rows = cones_row_count(cones, row);
    for (size_t i = 0; i < rows; i++) cones->impulse[row + i] = direction[i] * cones_limit(cones, row + i);
    row += rows;
  }
  memcpy(start, cones->impulse, cones->impulses->count * sizeof *start);
}

bool cone_impulses_have_others(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                               const double *rate, const double *impulse) {
  struct Cones cones;
  size_t n = impulses->count, starts = sizeof start_directions / sizeof *start_directions;
  double *work = create_cones(resolution, impulses, rate, NULL, &cones);
  bool is_other = false, moves = work != NULL && fill_scales(&cones);
  for (size_t i = 0; i < impulses->contact_count * starts && moves && !is_other; i++) {
    fill_start(&cones, impulse, i / starts, start_directions[i % starts], work + n);
    double miss = come_to_law(&cones, OTHER_LAW_TRIALS, work, work + n, work + 2 * n);
    is_other = miss <= law_nearly_holds && is_other_outcome(impulses, cones.impulse, impulse);
  }
  if (work != NULL) scratch_return(resolution->instance, SCRATCH_CONES);
  return is_other;
}
