/*
 * Impulses p of contacts and frictions. With the rates u = rate + W p they fulfil Signorini's and Coulomb's conditions:
 *
 *   contact:   u >= 0,  p >= 0,  u p = 0,
 *   friction:  |p| <= mu p_contact,  and  p = -mu p_contact u / |u|  where u is not 0.
 *
 * It tries in turn:
 *
 * 1. A semismooth Newton method, from no impulse (cone_newton.c).
 * 2. Projected gradient sweeps, O(n^2) each: all impulses take a step against their rates, and are projected. Newton's
 *    method follows after 10 sweeps, after 20 more, and so on, up to LAW_TRIALS times.
 * 3. An interior-point method (cone_interior.c).
 * 4. Gauss-Seidel sweeps, in which the impulses change one after another, as in 2, but many more of them.
 *
 * Without friction the problem is convex, and the active set method (active_set.c) takes the place of 2 to 4.
 *
 * All impulses of a step in 1 to 3 change at once, so that the result does not depend on their order. A symmetric
 * problem has symmetric impulses, also where there are several solutions.
 *
 * The search fails if the best residual is larger than law_roughly_holds and than the rounding error of the rates.
 * Friction that presses a contact together may leave no solution (Painleve's paradox).
 *
 * The same conditions hold between forces and accelerations at rest (plane_rests.c, resting_forces.c).
 */
#include "nonsmooth/cones/cone_search.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "nonsmooth/cones/active_set.h"
#include "nonsmooth/cones/cone_newton.h"
#include "support/arena.h"

/* Trials; where the interior path fails for forces, there are more, and most in turn. */
enum { LAW_TRIALS = 4, LAW_TRIALS_ALONE = 12, LAW_TRIALS_IN_TURN = 11 };

/*
 * How many more sweeps each trial makes than the one before; the first one makes none. In turn the number doubles with
 * each trial, up to 10,000 sweeps in all. They converge slowly where many contacts share a load.
 */
enum { LAW_SWEEPS = 10 };

/* A relative residual at which a search ends. */
static const double law_holds = 1e-12;

/* Returns the sum of a row's sizes in W, scaled such that W_ii = 1, times W_ii. The largest sum bounds eigenvalues. */
static double bound_of_row(const struct Cones *cones, size_t row) {
  size_t n = cones->impulses->count;
  double sum = 0.0;
  for (size_t j = 0; j < n; j++)
    if (cones->scale[j] > 0.0)
      sum += fabs(cones->impulses->delassus[row * n + j]) * sqrt(cones->scale[row] / cones->scale[j]);
  return fmax(sum, cones->scale[row]);
}

/* Fills the steps of a sweep: 1 / bound of a row, or 1 / W_ii in turn; 0 for a scale of 0. A plane has one step. */
static void fill_sweep_steps(const struct Cones *cones, enum Sweeps kind, double *step) {
  for (size_t row = 0; row < cones->impulses->count;) {
    size_t rows = cones_row_count(cones, row);
    double bound = 0.0;
    for (size_t i = row; i < row + rows; i++)
      bound = fmax(bound, kind == IN_TURN ? cones->scale[i] : bound_of_row(cones, i));
    for (size_t i = row; i < row + rows; i++) step[i] = cones->scale[i] > 0.0 ? 1.0 / bound : 0.0;
    row += rows;
  }
}

/* Takes a step against the rates, and projects it onto the disk of the limit, or the interval. */
static void update_friction_impulse(struct Cones *cones, size_t row, size_t rows, const double *rate, double step) {
  double whole[2] = {0.0, 0.0}, limit = fmax(cones_limit(cones, row), 0.0);
  for (size_t i = 0; i < rows; i++) whole[i] = cones->impulse[row + i] - step * rate[i];
  double size = hypot(whole[0], whole[1]), share = size > limit ? limit / size : 1.0;
  for (size_t i = 0; i < rows; i++) cones->impulse[row + i] = share * whole[i];
}

static void sweep_impulses(struct Cones *cones, enum Sweeps kind, int count) {
  size_t n = cones->impulses->count;
  double *rate = cones->work, *step = rate + n;
  fill_sweep_steps(cones, kind, step);
  for (int k = 0; k < count; k++) {
    for (size_t row = 0; row < n && kind == AT_ONCE; row++) rate[row] = cones_rate_behind(cones, row);
    for (size_t row = 0; row < n; row += cones_row_count(cones, row)) {
      size_t rows = cones_row_count(cones, row);
      for (size_t i = row; i < row + rows && kind == IN_TURN; i++) rate[i] = cones_rate_behind(cones, i);
      if (row < cones->impulses->contact_count)
        cones->impulse[row] = fmax(cones->impulse[row] - step[row] * rate[row], 0.0);
      else if (step[row] > 0.0) update_friction_impulse(cones, row, rows, rate + row, step[row]);
    }
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

bool cones_fill_scales(struct Cones *cones) {
  bool moves = true;
  for (size_t row = 0; row < cones->impulses->count;) {
    size_t rows = cones_row_count(cones, row);
    for (size_t i = 0; i < rows; i++) cones->scale[row + i] = scale_of_impulse(cones, row, rows);
    moves &= row >= cones->impulses->contact_count || cones->scale[row] > 0.0;
    row += rows;
  }
  return moves;
}

double cones_search_from(struct Cones *cones, enum Sweeps kind, int trials) {
  size_t bytes = cones->impulses->count * sizeof(double);
  double least = INFINITY;
  for (int trial = 0; trial < trials && !(least <= law_holds); trial++) {
    memcpy(cones->impulse, cones->swept, bytes);
    if (trial > 0) sweep_impulses(cones, kind, kind == IN_TURN ? LAW_SWEEPS << (trial - 1) : LAW_SWEEPS * trial);
    memcpy(cones->swept, cones->impulse, bytes);
    double miss = cones_relative_miss(cones, cone_newton(cones, whole_step, cones->work));
    if (miss < least) memcpy(cones->best, cones->impulse, bytes);
    least = fmin(least, miss);
  }
  memcpy(cones->impulse, cones->best, bytes);
  return least;
}

size_t cones_lay_out(struct Cones *cones, size_t n, double *block) {
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, n, &cones->scale, &cones->best, &cones->swept);
  size_t method = cones->path != NULL ? cones->path->work_count(n) : cone_newton_work_count(n);
  size_t active_set = active_set_work_count(n);
  ARENA_NUMBERS(&arena, method > active_set ? method : active_set, &cones->work);
  return (arena.next - (uintptr_t)block) / sizeof(double);
}

/* True if the residual is small, or a rounding error of velocities, as in the slowest impacts. */
static bool is_accepted(struct Cones *cones, double miss) {
  return miss <= law_roughly_holds || cone_newton(cones, whole_step, cones->work) <= cones->impulses->rounding;
}

/* Finds impulses of contacts without friction by the active set method. False if they do not fulfil the law. */
static bool is_pressed(struct Cones *cones) {
  active_set_find(cones, cones->work);
  double miss = cone_newton(cones, whole_step, cones->work);
  return miss <= cones->impulses->uncertain || is_accepted(cones, cones_relative_miss(cones, miss));
}

/* Sweeps from no impulse. */
static double search_by_sweeps(struct Cones *cones, enum Sweeps kind, int trials) {
  memset(cones->swept, 0, cones->impulses->count * sizeof *cones->swept);
  return cones_search_from(cones, kind, trials);
}

bool cones_find_impulses(struct Cones *cones) {
  if (!cones_fill_scales(cones)) return false;
  bool is_convex = cones->path == NULL || active_set_applies(cones);
  double miss = cones_search_from(cones, AT_ONCE, is_convex ? 1 : LAW_TRIALS);
  if (miss <= law_holds) return true;
  if (is_convex) return is_pressed(cones);
  double other = cones->path->find(cones, law_holds, false, cones->work);
  if (!(other < miss)) memcpy(cones->impulse, cones->best, cones->impulses->count * sizeof *cones->best);
  return is_accepted(cones, fmin(other, miss)) ||
         is_accepted(cones, search_by_sweeps(cones, IN_TURN, LAW_TRIALS_IN_TURN));
}

double cones_find_forces(struct Cones *cones) {
  if (!cones_fill_scales(cones)) return INFINITY;
  double miss = cones->path->find(cones, law_holds, true, cones->work);
  if (miss > law_roughly_holds) miss = search_by_sweeps(cones, AT_ONCE, LAW_TRIALS_ALONE);
  return miss <= law_roughly_holds ? miss : search_by_sweeps(cones, IN_TURN, LAW_TRIALS_IN_TURN);
}

size_t pressing_forces_work_count(const struct ConePath *path, size_t n) {
  struct Cones cones = {.path = path};
  return cones_lay_out(&cones, n, NULL);
}

bool pressing_forces_find(const struct ConePath *path, size_t n, double *delassus, const double *rate, double *force,
                          double *work) {
  struct ContactImpulses contacts = {.contact_count = n, .count = n, .deciding_count = n, .delassus = delassus};
  struct Cones cones = {.path = path, .impulses = &contacts, .rate = rate, .impulse = force};
  size_t count = cones_lay_out(&cones, n, work);
  memset(force, 0, n * sizeof *force);
  memset(work, 0, count * sizeof *work);
  return cones_find_impulses(&cones);
}
