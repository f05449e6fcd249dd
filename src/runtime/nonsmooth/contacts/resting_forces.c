/*
 * Solves a = free + S F, a >= 0, F >= 0, F^T a = 0, in groups of contacts that S couples. Cholesky's factorization
 * shows whether the symmetric part of S is positive definite. If so, the solution exists and is unique (Cottle,
 * Pang and Stone, The Linear Complementarity Problem, chapter 3). Else all 2^n active sets are tried, in groups of
 * n <= COMBINED_LIMIT contacts. F of an active set follows from a = 0 on it, by elimination, at a cost of O(2^n
 * n^3). Active sets with a singular matrix are skipped. Solutions with equal accelerations count as one motion. In
 * larger groups cone_search.c finds one solution, if any; whether there are others stays unknown.
 *
 * Without sliding friction S is symmetric, and the accelerations are unique. All contacts are then solved at once.
 *
 * If several solutions exist during a motion, the present forces are kept if they are stable under compliance. If they
 * are not a solution, because a contact closes, damped compliant contacts lead from them to one.
 */
#include "nonsmooth/contacts/resting_forces.h"

#include <math.h>

#include "arithmetic.h"
#include "nonsmooth/cones/cone_search.h"
#include "support/elimination.h"

/* Contacts of a group up to which all active sets are tried: at most 4096. */
enum { COMBINED_LIMIT = 12 };

/* S is positive definite if the pivots of its symmetric part exceed the square of this; S_ii = 1 without friction. */
static const double locking_share = 1e-3;

/* Smaller elements of S are rounding errors and couple no contacts; S is scaled to a size of 1. */
static const double least_coupling = 1e-13;

static size_t work_count(const struct ConePath *path, size_t count) {
  return count * count + 2 * count + pressing_forces_work_count(path, count);
}

size_t resting_forces_bytes(const struct ConePath *path, size_t count) {
  return (count * count + 6 * count + work_count(path, count)) * sizeof(double) + count * sizeof(size_t);
}

struct RestingForces resting_forces_in(void *block, const struct ConePath *path, size_t count) {
  struct RestingForces resting = {.count = count, .path = path, .s = block};
  resting.free = resting.s + count * count;
  resting.present = resting.free + count;
  resting.found = resting.present + count;
  resting.found_force = resting.found + count;
  resting.force = resting.found_force + count;
  resting.motion = resting.force + count;
  resting.work = resting.motion + count;
  resting.group = (size_t *)(resting.work + work_count(path, count));
  return resting;
}

double largest_free_acceleration(const struct RestingForces *resting) {
  double size = 0.0;
  for (size_t i = 0; i < resting->count; i++) size = fmax(size, fabs(resting->free[i]));
  return size;
}

static double between(const struct RestingForces *resting, size_t i, size_t j) {
  return resting->s[resting->group[i] * resting->count + resting->group[j]];
}

static bool act_on_each_other(const struct RestingForces *resting, size_t i, size_t j) {
  size_t n = resting->count;
  return fmax(fabs(resting->s[i * n + j]), fabs(resting->s[j * n + i])) > least_coupling;
}

/* Collects the contacts that S couples with the first one, directly or through others, in ascending order. */
static void collect_group(struct RestingForces *resting, size_t first) {
  size_t n = resting->count;
  double *is_member = resting->force;
  for (size_t i = 0; i < n; i++) is_member[i] = i == first ? 1.0 : 0.0;
  for (bool grows = true; grows;) {
    grows = false;
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++) {
        if (is_member[i] == 0.0 || is_member[j] != 0.0 || !act_on_each_other(resting, i, j)) continue;
        is_member[j] = 1.0;
        grows = true;
      }
  }
  resting->group_count = 0;
  for (size_t i = 0; i < n; i++)
    if (is_member[i] != 0.0) resting->group[resting->group_count++] = i;
}

static void collect_all(struct RestingForces *resting) {
  resting->group_count = resting->count;
  for (size_t i = 0; i < resting->count; i++) resting->group[i] = i;
}

/* True if the symmetric part of S is positive definite in the group: then the solution is unique. */
static bool is_surely_one(const struct RestingForces *resting) {
  size_t n = resting->group_count;
  double *l = resting->work;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = 0.5 * (between(resting, i, j) + between(resting, j, i));
      for (size_t k = 0; k < j; k++) sum -= l[i * n + k] * l[j * n + k];
      if (i == j && !(sum > locking_share * locking_share)) return false;
      l[i * n + j] = i == j ? sqrt(sum) : sum / l[j * n + j];
    }
  return true;
}

/* Finds the forces that keep a = 0 on an active set, a bit for each contact. False if S is singular there. */
static bool find_forces(const struct RestingForces *resting, unsigned combination) {
  size_t member[COMBINED_LIMIT], count = 0;
  double *a = resting->work;
  for (size_t i = 0; i < resting->group_count; i++)
    if ((combination >> i & 1u) != 0) member[count++] = i;
  size_t width = count + 1;
  for (size_t i = 0; i < count; i++) {
    for (size_t j = 0; j < count; j++) a[i * width + j] = between(resting, member[i], member[j]);
    a[i * width + count] = -resting->free[resting->group[member[i]]];
  }
  if (!solve_by_elimination(count, a, usual_least_pivot)) return false;
  for (size_t i = 0; i < resting->group_count; i++) resting->force[resting->group[i]] = 0.0;
  for (size_t i = 0; i < count; i++) resting->force[resting->group[member[i]]] = a[i * width + count];
  return true;
}

/* True if no force is negative and no gap closes. Stores the accelerations in motion. */
static bool is_solution(const struct RestingForces *resting, double size) {
  bool is_fine = true;
  for (size_t i = 0; i < resting->group_count; i++) {
    size_t contact = resting->group[i];
    double change = 0.0, terms = size;
    for (size_t j = 0; j < resting->group_count; j++) {
      double term = between(resting, i, j) * resting->force[resting->group[j]];
      change += term;
      terms = fmax(terms, fabs(term));
    }
    resting->motion[contact] = resting->free[contact] + change;
    is_fine &= resting->force[contact] >= -rounded_force * size && resting->motion[contact] >= -rounded_force * terms;
  }
  return is_fine;
}

static bool is_same_motion(const struct RestingForces *resting, double size) {
  double change = 0.0, terms = size;
  for (size_t i = 0; i < resting->group_count; i++) {
    size_t contact = resting->group[i];
    change = fmax(change, fabs(resting->motion[contact] - resting->found[contact]));
    terms = fmax(terms, fabs(resting->force[contact]));
  }
  return change <= 1e3 * rounded_force * terms;
}

static void note_solution(const struct RestingForces *resting) {
  for (size_t i = 0; i < resting->group_count; i++) {
    resting->found[resting->group[i]] = resting->motion[resting->group[i]];
    resting->found_force[resting->group[i]] = resting->force[resting->group[i]];
  }
}

/* Counts the motions by trying all active sets, up to the second motion; stores the first one. */
static enum RestingSolutions count_motions(const struct RestingForces *resting, double size) {
  int count = 0;
  for (unsigned combination = 0; combination < 1u << resting->group_count && count < 2; combination++) {
    if (!find_forces(resting, combination) || !is_solution(resting, size)) continue;
    if (count > 0 && is_same_motion(resting, size)) continue;
    if (count++ == 0) note_solution(resting);
  }
  return count == 0 ? NO_MOTION : count == 1 ? ONE_MOTION : SEVERAL_MOTIONS;
}

/* Finds the forces of a group at free accelerations scaled to a size of 1. False if none are found. */
static bool find_in_group(const struct RestingForces *resting, double size) {
  size_t n = resting->group_count;
  double *matrix = resting->work, *q = matrix + n * n, *z = q + n;
  for (size_t i = 0; i < n; i++) {
    q[i] = size > 0.0 ? resting->free[resting->group[i]] / size : 0.0;
    for (size_t j = 0; j < n; j++) matrix[i * n + j] = between(resting, i, j);
  }
  if (!pressing_forces_find(resting->path, n, matrix, q, z, z + n)) return false;
  for (size_t i = 0; i < n; i++) resting->force[resting->group[i]] = z[i] * size;
  return true;
}

/*
 * Follows the forces of damped compliant contacts, dF/dt = -(free + S F) with F >= 0, by Euler's steps to rest. False
 * if they do not come to rest at a solution. Stores its accelerations in motion.
 */
static bool relax_forces(const struct RestingForces *resting, double size) {
  const int steps = 20000; /* enough where the eigenvalues of S exceed 1e-3 of its largest element */
  const double rest = 1e-3 * rounded_force;
  size_t n = resting->group_count;
  double largest = 0.0, *next = resting->work, change = INFINITY;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) largest = fmax(largest, fabs(between(resting, i, j)));
  double step = 1.0 / (largest * (double)n);
  for (int k = 0; k < steps && change > rest * size; k++) {
    change = 0.0;
    for (size_t i = 0; i < n; i++) {
      double rate = resting->free[resting->group[i]], force = resting->force[resting->group[i]];
      for (size_t j = 0; j < n; j++) rate += between(resting, i, j) * resting->force[resting->group[j]];
      next[i] = fmax(force - step * rate, 0.0);
      change = fmax(change, fabs(next[i] - force));
    }
    for (size_t i = 0; i < n; i++) resting->force[resting->group[i]] = next[i];
  }
  return is_solution(resting, size);
}

static void take_present(const struct RestingForces *resting) {
  for (size_t i = 0; i < resting->group_count; i++)
    resting->force[resting->group[i]] = resting->present[resting->group[i]];
}

/* Returns the smallest of the present forces that press; size if none does. */
static double smallest_force(const struct RestingForces *resting, double size) {
  double smallest = size;
  for (size_t i = 0; i < resting->group_count; i++) {
    double force = resting->present[resting->group[i]];
    if (force > rounded_force * size) smallest = fmin(smallest, force);
  }
  return smallest;
}

/*
 * True if the present forces are stable under compliance: after a small change they return to the same motion (P. E.
 * Dupont and S. P. Yamajako: Stability of frictional contact in constrained rigid-body dynamics, IEEE Transactions on
 * Robotics and Automation 13, 1997). Then the motion continues, although there may be other solutions.
 */
static bool is_stable(const struct RestingForces *resting, double size) {
  double nudge = 1e-3 * smallest_force(resting, size);
  take_present(resting);
  if (!is_solution(resting, size)) return false;
  note_solution(resting);
  for (size_t i = 0; i < resting->group_count; i++)
    if (resting->force[resting->group[i]] > nudge) resting->force[resting->group[i]] += i % 2 == 0 ? nudge : -nudge;
  return relax_forces(resting, size) && is_same_motion(resting, size);
}

/* Counts the motions. During a motion, it takes that of several which the present forces lead to under compliance. */
static enum RestingSolutions choose_motion(const struct RestingForces *resting, bool is_solved, double size) {
  enum RestingSolutions solutions = count_motions(resting, size);
  if (solutions != SEVERAL_MOTIONS || is_solved || !resting->lasts) return solutions;
  take_present(resting);
  if (!relax_forces(resting, size)) return solutions;
  note_solution(resting);
  return ONE_MOTION;
}

static enum RestingSolutions solve_group(const struct RestingForces *resting, bool is_solved, double size) {
  bool is_one = is_surely_one(resting), is_small = resting->group_count <= COMBINED_LIMIT;
  if (is_solved && (is_one || (is_small && resting->lasts && is_stable(resting, size)))) return ONE_MOTION;
  if (is_small) return choose_motion(resting, is_solved, size);
  if (!is_solved && !(find_in_group(resting, size) && is_solution(resting, size)))
    return is_one ? NO_MOTION : PERHAPS_NONE;
  if (!is_solved) note_solution(resting);
  return is_one ? ONE_MOTION : PERHAPS_OTHERS;
}

bool resting_forces_press(struct RestingForces *resting) {
  double size = largest_free_acceleration(resting);
  collect_all(resting);
  if (!find_in_group(resting, size)) return false;
  is_solution(resting, size); /* fills the accelerations, which uncertain directions may leave below 0 */
  note_solution(resting);
  return true;
}

enum RestingSolutions resting_forces_solve(struct RestingForces *resting, bool is_solved) {
  double size = largest_free_acceleration(resting);
  enum RestingSolutions worst = ONE_MOTION;
  collect_all(resting);
  if (is_solved && is_surely_one(resting)) return worst;
  for (size_t i = 0; i < resting->count; i++) {
    collect_group(resting, i);
    if (resting->group[0] != i) continue; /* this group was handled before */
    enum RestingSolutions solutions = solve_group(resting, is_solved, size);
    /* The present forces are a solution, even if rounding hides it among the active sets. */
    if (is_solved && solutions == NO_MOTION) solutions = ONE_MOTION;
    if (solutions > worst) worst = solutions;
  }
  return worst;
}
