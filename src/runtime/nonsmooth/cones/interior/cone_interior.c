/*
 * Primal-dual interior-point method for the law of contact and friction, as a problem over second-order cones. A
 * contact has the pair s >= 0, its impulse, and y >= 0, its rate behind. A friction has the pair
 *
 *   s = (limit, p),   y = (y0, u),   u: its rate behind,
 *
 * both in the cone of vectors (a, b) with a >= |b|. The limit is a linear function of the impulses. The law is
 * u = rate + W p and s o y = 0, where o is the product of the cone's Jordan algebra. The central path holds the
 * solutions of s o y = mu e, e the unit, for mu > 0. The method follows it as mu falls to 0. With the scaling Q of
 * Nesterov and Todd, Q s = y, the linearized equations for a step dp are
 *
 *   (W + Q) dp = t - rate - W p,   y + dy = t - Q ds,   t = mu / s.
 *
 * A step takes one elimination, O(n^3), and ends before the boundary. Where several impulses fulfil the law, the path
 * ends in the interior of their set: forces of redundant supports have a margin to their limits. Once mu is small, the
 * semismooth Newton method of cone_newton.c ends the search.
 *
 * Coulomb's law is not associated: sliding does not open a contact. The path may therefore end in front of a solution.
 * Then the associated problem is solved, which is convex. There the rate of each contact is reduced by mu |u| of its
 * frictions. |u| is that of the last solution, and the problem is solved again until it does not change (V. Acary and
 * F. Cadoux: Applications of an existence result for the Coulomb friction problem, Recent Advances in Contact
 * Mechanics, 2013). Where nothing slides, u = 0, and the first such problem finds the forces if there are any. For forces
 * it therefore comes first: frictions that can carry the load do, even if they could also slip.
 *
 * The path of Coulomb's law may come near others. It is followed closely: mu falls by a given factor. The convex problem
 * has one path, and longer steps: a predictor with t = 0, then a corrector. That has the mu which the predictor allows,
 * and the terms of second order that it left out (S. Mehrotra: On the implementation of a primal-dual interior point
 * method, SIAM Journal on Optimization 2, 1992).
 */
#include "nonsmooth/cones/interior/cone_interior.h"

#include <math.h>
#include <string.h>

#include "nonsmooth/cones/cone_newton.h"
#include "nonsmooth/cones/interior/cone_pairs.h"
#include "support/arena.h"
#include "support/elimination.h"

/* Steps of a path at most; steps between two trials of Newton's method; associated problems at most. */
enum { PATH_STEPS = 40, TRIAL_STEPS = 3, ASSOCIATED_LIMIT = 60, UNDAMPED_LIMIT = 20 };

/* Part of the way to the boundary that a step keeps. */
static const double inside = 0.99;

/* mu of the next point of the path of Coulomb's law, relative to the present one, after a long step and a short one. */
static const double centering[] = {0.1, 0.5};
static const double long_step = 0.6;

/* Least mu of a corrector, relative to the present one. */
static const double least_centering = 1e-3;

/*
 * Pivots of W + Q that count as 0; elements of W are of order 1. Q falls with mu, and determines the forces that W does
 * not, those of redundant supports.
 */
static const double least_path_pivot = 1e-15;

/* mu at which Newton's method is tried at each step, and at which the path ends; rates and impulses are of order 1. */
static const double nearly_none = 1e-6, none = 1e-15;

/* mu at which it is tried on a centered path. Below it, rounding of W decides on the forces that W does not determine. */
static const double nearly_rounded = 1e-12;

/*
 * A residual up to which a path has ended at a solution. Where a friction that sticks is at its limit, both s and y of
 * its pair fall as sqrt(mu), and the associated problem ends no nearer.
 */
static const double nearly_solved = 1e-6;

/* A problem scaled such that W_ii = 1 and the largest rate is 1. Vectors have an element a row. */
struct Interior {
  struct Cones *cones;
  size_t n, degree;         /* degree: number of pairs */
  double size;              /* largest rate, in units of the rows */
  double *unit;             /* 1 / sqrt(W_ii); 0 for a row that takes no part */
  double *x, *dual;         /* impulse and rate behind */
  double *head, *dual_head; /* limit and y0, at the first row of a friction */
  double *dx, *ddual, *dhead, *ddual_head;
  double *target, *target_head; /* t of a step */
  struct Scaling *scaling;      /* at the first row of a friction */
  double *shift;                /* mu |u| of the last solution, for the associated problem */
  double *equations;            /* n rows of n + 1 */
  size_t *order;                /* of the eliminated equations */
  double *missing, *right;      /* right sides without and with t */
  double *missing_limit;        /* limit minus head of a friction; a path may start with some, and removes it */
  double *best;                 /* impulses with the least residual */
  double *newton;               /* workspace of cone_newton() */
  double least, enough;         /* this residual, and one that ends the search */
  bool is_associated, is_centered;
};

/* Divides the workspace. start_path() fills x to ddual_head at once. */
static size_t lay_out_interior(struct Interior *interior, size_t n, double *work) {
  struct Arena arena = {(uintptr_t)work};
  ARENA_NUMBERS(&arena, n, &interior->unit, &interior->x, &interior->dual, &interior->head, &interior->dual_head,
                &interior->dx, &interior->ddual, &interior->dhead, &interior->ddual_head, &interior->target,
                &interior->target_head, &interior->shift, &interior->missing, &interior->right,
                &interior->missing_limit, &interior->best);
  ARENA_NUMBERS(&arena, n * (n + 1), &interior->equations);
  ARENA_TAKE(&arena, interior->scaling, n);
  ARENA_TAKE(&arena, interior->order, n);
  ARENA_NUMBERS(&arena, cone_newton_work_count(n), &interior->newton);
  return (arena.next - (uintptr_t)work) / sizeof(double);
}

size_t cone_interior_work_count(size_t n) {
  struct Interior interior;
  return lay_out_interior(&interior, n, NULL);
}

static bool takes_part(const struct Interior *interior, size_t row) {
  return interior->unit[row] > 0.0;
}

static bool is_contact_row(const struct Interior *interior, size_t row) {
  return row < interior->cones->impulses->contact_count;
}

static size_t size_of_pair(const struct Interior *interior, size_t row) {
  return 1 + cones_row_count(interior->cones, row);
}

/* Returns the limit of a friction by a unit impulse of a row that decides on limits. */
static double scaled_coefficient(const struct Interior *interior, size_t row, size_t deciding) {
  return cones_coefficient(interior->cones, row, deciding) * interior->unit[deciding] / interior->unit[row];
}

/* Returns the part of the limit of a friction that no row decides. */
static double given_limit(const struct Interior *interior, size_t row) {
  const struct ContactImpulses *impulses = interior->cones->impulses;
  double given = impulses->given != NULL ? impulses->given[row - impulses->contact_count] : 0.0;
  return given / (interior->unit[row] * interior->size);
}

static double scaled_delassus(const struct Interior *interior, size_t i, size_t j) {
  const struct ContactImpulses *impulses = interior->cones->impulses;
  return impulses->delassus[i * impulses->count + j] * interior->unit[i] * interior->unit[j];
}

/* Returns the part of a limit that impulses x decide. */
static double limit_of(const struct Interior *interior, size_t row, const double *x) {
  double limit = 0.0;
  for (size_t i = 0; i < interior->cones->impulses->deciding_count; i++)
    limit += scaled_coefficient(interior, row, i) * x[i];
  return limit;
}

/* Copies the pairs of a friction: its head, and the rows of its tail. */
static void copy_pair(const struct Interior *interior, size_t row, const double *head, const double *tail,
                      double *pair) {
  pair[0] = head[row];
  for (size_t i = 1; i < size_of_pair(interior, row); i++) pair[i] = tail[row + i - 1];
}

/* Fills a row of W, with minus the rate behind as its right side. */
static void fill_row(const struct Interior *interior, size_t row) {
  double *equation = interior->equations + row * (interior->n + 1);
  double behind = interior->cones->rate[row] * interior->unit[row] / interior->size;
  for (size_t j = 0; j < interior->n; j++) {
    equation[j] = scaled_delassus(interior, row, j);
    behind += equation[j] * interior->x[j];
  }
  if (!takes_part(interior, row)) equation[row] = 1.0;
  equation[interior->n] = 0.0;
  interior->missing[row] = -behind - (interior->is_associated ? interior->shift[row] : 0.0);
}

/* Adds the terms by which the associated law couples a friction with the rows that decide on its limit. */
static void associate(const struct Interior *interior, size_t row) {
  const struct Scaling *scaling = &interior->scaling[row];
  size_t deciding = interior->cones->impulses->deciding_count, width = interior->n + 1;
  for (size_t i = 0; i < deciding; i++) {
    double *equation = interior->equations + i * width, coefficient = scaled_coefficient(interior, row, i);
    if (coefficient == 0.0) continue;
    for (size_t j = 0; j < deciding; j++)
      equation[j] += coefficient * scaling_element(scaling, 0, 0) * scaled_coefficient(interior, row, j);
    for (size_t k = 1; k < size_of_pair(interior, row); k++)
      equation[row + k - 1] += coefficient * scaling_element(scaling, 0, k);
  }
}

static void fill_equations_of_friction(const struct Interior *interior, size_t row) {
  size_t size = size_of_pair(interior, row);
  double s[CONE_SIZE] = {0.0}, y[CONE_SIZE] = {0.0};
  struct Scaling *scaling = &interior->scaling[row];
  copy_pair(interior, row, interior->head, interior->x, s);
  copy_pair(interior, row, interior->dual_head, interior->dual, y);
  *scaling = scaling_of(s, y, size);
  interior->missing_limit[row] = given_limit(interior, row) + limit_of(interior, row, interior->x) - s[0];
  for (size_t k = 1; k < size; k++) {
    double *equation = interior->equations + (row + k - 1) * (interior->n + 1);
    for (size_t i = 0; i < interior->cones->impulses->deciding_count; i++)
      equation[i] += scaling_element(scaling, k, 0) * scaled_coefficient(interior, row, i);
    for (size_t j = 1; j < size; j++) equation[row + j - 1] += scaling_element(scaling, k, j);
  }
  if (interior->is_associated) associate(interior, row);
}

/* Fills W + Q. */
static void fill_path_equations(const struct Interior *interior) {
  for (size_t row = 0; row < interior->n; row++) fill_row(interior, row);
  for (size_t row = 0; row < interior->n; row += cones_row_count(interior->cones, row)) {
    if (!takes_part(interior, row)) continue;
    if (is_contact_row(interior, row))
      interior->equations[row * (interior->n + 2)] += interior->dual[row] / interior->x[row];
    else fill_equations_of_friction(interior, row);
  }
}

static void add_target_of_friction(const struct Interior *interior, size_t row) {
  const struct Scaling *scaling = &interior->scaling[row];
  double missing = interior->missing_limit[row];
  double head = interior->target_head[row] - scaling_element(scaling, 0, 0) * missing;
  for (size_t k = 1; k < size_of_pair(interior, row); k++)
    interior->right[row + k - 1] += interior->target[row + k - 1] - scaling_element(scaling, k, 0) * missing;
  for (size_t i = 0; i < interior->cones->impulses->deciding_count && interior->is_associated; i++)
    interior->right[i] += scaled_coefficient(interior, row, i) * head;
}

/* Fills the right sides for t. */
static void fill_right_sides(const struct Interior *interior) {
  memcpy(interior->right, interior->missing, interior->n * sizeof *interior->right);
  for (size_t row = 0; row < interior->n; row += cones_row_count(interior->cones, row)) {
    if (!takes_part(interior, row)) continue;
    if (is_contact_row(interior, row)) interior->right[row] += interior->target[row];
    else add_target_of_friction(interior, row);
  }
}

/* Computes the step of a friction's duals from that of the impulses. Returns the longest step of its pairs. */
static double find_step_of_friction(const struct Interior *interior, size_t row) {
  size_t size = size_of_pair(interior, row);
  double s[CONE_SIZE] = {0.0}, y[CONE_SIZE] = {0.0}, ds[CONE_SIZE] = {0.0}, dy[CONE_SIZE] = {0.0}, t[CONE_SIZE];
  copy_pair(interior, row, interior->head, interior->x, s);
  copy_pair(interior, row, interior->dual_head, interior->dual, y);
  copy_pair(interior, row, interior->target_head, interior->target, t);
  interior->dhead[row] = limit_of(interior, row, interior->dx) + interior->missing_limit[row];
  copy_pair(interior, row, interior->dhead, interior->dx, ds);
  scale_pair(&interior->scaling[row], size, ds, dy);
  for (size_t i = 0; i < size; i++) dy[i] = t[i] - y[i] - dy[i];
  interior->ddual_head[row] = dy[0];
  for (size_t i = 1; i < size; i++) interior->ddual[row + i - 1] = dy[i];
  return fmin(longest_step_in_cone(s, ds, size), longest_step_in_cone(y, dy, size));
}

static double find_step_of_contact(const struct Interior *interior, size_t row) {
  double x = interior->x[row], dual = interior->dual[row], *dx = &interior->dx[row], *ddual = &interior->ddual[row];
  *ddual = interior->target[row] - dual - dual / x * *dx;
  return fmin(*dx < 0.0 ? -x / *dx : INFINITY, *ddual < 0.0 ? -dual / *ddual : INFINITY);
}

/* Finds the step for t. Returns its length up to the boundary; NaN if it is not finite. */
static double find_step_to_targets(const struct Interior *interior) {
  double longest = INFINITY;
  fill_right_sides(interior);
  solve_eliminated(interior->n, interior->equations, interior->order, interior->right, interior->dx);
  for (size_t row = 0; row < interior->n; row += cones_row_count(interior->cones, row)) {
    if (!takes_part(interior, row)) continue;
    double length =
        is_contact_row(interior, row) ? find_step_of_contact(interior, row) : find_step_of_friction(interior, row);
    if (isnan(length)) return length;
    longest = fmin(longest, length);
  }
  return longest;
}

/* Returns mu, the mean product of the pairs, behind a part of the step. */
static double mean_product(const struct Interior *interior, double length) {
  double sum = 0.0;
  for (size_t i = 0; i < interior->n; i++) {
    sum += (interior->x[i] + length * interior->dx[i]) * (interior->dual[i] + length * interior->ddual[i]);
    sum +=
        (interior->head[i] + length * interior->dhead[i]) * (interior->dual_head[i] + length * interior->ddual_head[i]);
  }
  return sum / (double)interior->degree;
}

static void find_target_of_friction(const struct Interior *interior, size_t row, double mu) {
  size_t size = size_of_pair(interior, row);
  double s[CONE_SIZE] = {0.0}, ds[CONE_SIZE] = {0.0}, dy[CONE_SIZE] = {0.0}, target[CONE_SIZE];
  copy_pair(interior, row, interior->head, interior->x, s);
  copy_pair(interior, row, interior->dhead, interior->dx, ds);
  copy_pair(interior, row, interior->ddual_head, interior->ddual, dy);
  fill_target(&interior->scaling[row], size, s, ds, dy, mu, target);
  interior->target_head[row] = target[0];
  for (size_t i = 1; i < size; i++) interior->target[row + i - 1] = target[i];
}

/* Fills t with which a step leads to mu, from that of a predictor; for a step of 0 it is mu / s. */
static void find_targets(const struct Interior *interior, double mu) {
  for (size_t row = 0; row < interior->n; row += cones_row_count(interior->cones, row)) {
    if (!takes_part(interior, row)) continue;
    if (is_contact_row(interior, row))
      interior->target[row] = (mu - interior->dx[row] * interior->ddual[row]) / interior->x[row];
    else find_target_of_friction(interior, row, mu);
  }
}

/* Finds the predictor. Returns mu of the corrector, relative to the present one. */
static double predict_path(const struct Interior *interior, double mu) {
  memset(interior->target, 0, interior->n * sizeof *interior->target);
  memset(interior->target_head, 0, interior->n * sizeof *interior->target_head);
  double ahead = mean_product(interior, fmin(find_step_to_targets(interior), 1.0)) / mu;
  return fmin(fmax(ahead * ahead * ahead, least_centering), 1.0);
}

/* Finds a step from a point of the path, given the length of the last one. Returns its length; 0 without equations. */
static double find_path_step(const struct Interior *interior, double mu, double last) {
  fill_path_equations(interior);
  if (!eliminate(interior->n, interior->equations, least_path_pivot, interior->order)) return 0.0;
  double share = centering[last < long_step];
  if (interior->is_associated) share = predict_path(interior, mu);
  else memset(interior->dx, 0, 4 * interior->n * sizeof *interior->dx); /* and the vectors behind, up to ddual_head */
  find_targets(interior, share * mu);
  double longest = find_step_to_targets(interior);
  return isnan(longest) ? 0.0 : fmin(inside * longest, 1.0);
}

static void take_path_step(const struct Interior *interior, double length) {
  for (size_t i = 0; i < interior->n; i++) {
    interior->x[i] += length * interior->dx[i];
    interior->dual[i] += length * interior->ddual[i];
    interior->head[i] += length * interior->dhead[i];
    interior->dual_head[i] += length * interior->ddual_head[i];
  }
}

/* Tries Newton's method from the point of the path. True if its residual is small enough. */
static bool try_newton(struct Interior *interior) {
  struct Cones *cones = interior->cones;
  for (size_t i = 0; i < interior->n; i++)
    cones->impulse[i] = takes_part(interior, i) ? interior->x[i] * interior->unit[i] * interior->size : 0.0;
  double miss = cones_relative_miss(cones, cone_newton(cones, damped_step, interior->newton));
  if (!(miss < interior->least)) return false;
  interior->least = miss;
  memcpy(interior->best, cones->impulse, interior->n * sizeof *interior->best);
  return miss <= interior->enough;
}

/* Starts the path where all contacts press and no friction has a force. */
static void start_path(const struct Interior *interior) {
  memset(interior->x, 0, 8 * interior->n * sizeof *interior->x); /* and the vectors behind, up to ddual_head */
  for (size_t row = 0; row < interior->cones->impulses->contact_count; row++)
    interior->x[row] = interior->dual[row] = takes_part(interior, row) ? 1.0 : 0.0;
  for (size_t row = interior->cones->impulses->contact_count; row < interior->n;
       row += cones_row_count(interior->cones, row)) {
    if (!takes_part(interior, row)) continue;
    interior->head[row] = fmax(given_limit(interior, row) + limit_of(interior, row, interior->x), 1.0);
    interior->dual_head[row] = 1.0;
  }
}

/* Follows the path. True if impulses with a small enough residual are found. */
static bool follow_central_path(struct Interior *interior) {
  double mu = INFINITY, length = 1.0;
  start_path(interior);
  for (int step = 0; step < PATH_STEPS && length > 0.0 && mu > none; step++) {
    mu = mean_product(interior, 0.0);
    bool is_trial = !interior->is_associated && step % TRIAL_STEPS == TRIAL_STEPS - 1;
    bool is_near = interior->is_centered ? mu < nearly_rounded : mu < nearly_none || is_trial;
    if (is_near && try_newton(interior)) return true;
    length = find_path_step(interior, mu, length);
    take_path_step(interior, length);
  }
  return try_newton(interior);
}

/* Sets the shifts to mu |u| of the solution; damped ones to the mean with those before. */
static void update_shift(const struct Interior *interior, bool is_damped) {
  const struct ContactImpulses *impulses = interior->cones->impulses;
  for (size_t i = 0; i < impulses->deciding_count; i++) {
    double shift = 0.0, speed[CONE_SIZE] = {0.0};
    for (size_t row = impulses->contact_count; row < interior->n; row += cones_row_count(interior->cones, row)) {
      if (!takes_part(interior, row)) continue;
      copy_pair(interior, row, interior->dual_head, interior->dual, speed);
      shift += scaled_coefficient(interior, row, i) * length_of_tail(speed, size_of_pair(interior, row));
    }
    interior->shift[i] = is_damped ? 0.5 * (interior->shift[i] + shift) : shift;
  }
}

/* True if a row can have an impulse that changes its rate. */
static bool can_push(const struct Interior *interior, size_t row) {
  const struct ContactImpulses *impulses = interior->cones->impulses;
  if (!(interior->cones->scale[row] > 0.0)) return false;
  if (row < impulses->contact_count) return true;
  double most = impulses->given != NULL ? impulses->given[row - impulses->contact_count] : 0.0;
  for (size_t i = 0; i < impulses->deciding_count; i++)
    most = fmax(most, fabs(cones_coefficient(interior->cones, row, i)));
  return most > 0.0;
}

/* Fills the units and the largest rate, and counts the pairs. */
static void fill_units_of_rows(struct Interior *interior) {
  const struct Cones *cones = interior->cones;
  for (size_t row = 0; row < interior->n;) {
    size_t rows = cones_row_count(cones, row);
    bool can = can_push(interior, row);
    interior->degree += can ? 1 : 0;
    for (size_t i = row; i < row + rows; i++) {
      interior->unit[i] = can ? 1.0 / sqrt(cones->scale[i]) : 0.0;
      interior->size = fmax(interior->size, fabs(cones->rate[i]) * interior->unit[i]);
    }
    row += rows;
  }
}

/* Follows the path of centres of one of the problems. False if it ends in front of a solution. */
static bool follow_path_of(struct Interior *interior, bool is_associated, bool is_centered) {
  interior->is_associated = is_associated;
  interior->is_centered = is_centered;
  return follow_central_path(interior);
}

double cone_interior(struct Cones *cones, double enough, bool is_centered, double *work) {
  size_t n = cones->impulses->count;
  struct Interior interior = {.cones = cones, .n = n, .least = INFINITY, .enough = enough};
  lay_out_interior(&interior, n, work);
  memset(interior.best, 0, n * sizeof *interior.best);
  memset(interior.shift, 0, n * sizeof *interior.shift);
  fill_units_of_rows(&interior);
  if (interior.size > 0.0) {
    bool is_found = (is_centered && follow_path_of(&interior, true, true)) ||
                    follow_path_of(&interior, false, is_centered) ||
                    (is_centered && follow_path_of(&interior, false, false));
    for (int count = 0; count < ASSOCIATED_LIMIT && interior.least > nearly_solved && !is_found; count++) {
      is_found = follow_path_of(&interior, true, false);
      update_shift(&interior, count >= UNDAMPED_LIMIT);
    }
  } else interior.least = 0.0;
  memcpy(cones->impulse, interior.best, n * sizeof *interior.best);
  return interior.least;
}

const struct ConePath cone_path = {.work_count = cone_interior_work_count, .find = cone_interior};
