/*
 * Solves a = free + S F, a >= 0, F >= 0, F^T a = 0, in groups of contacts that S couples. Cholesky's factorization
 * shows whether the symmetric part of S is positive definite. If so, the solution exists and is unique (R. W. Cottle, J.-S.
 * Pang and R. E. Stone, The Linear Complementarity Problem, chapter 3). Else there may be none, or several. Then the
 * solution is that to which damped compliant contacts lead from the present forces (P. E. Dupont and S. P. Yamajako:
 * Stability of frictional contact in constrained rigid-body dynamics, IEEE Transactions on Robotics and Automation 13, 1997).
 * Present forces that are a solution are kept, unless a small change lets them go over to another one.
 *
 * Compliant contacts may not come to rest. Then contacts are exchanged one by one between those that press and the others
 * (chapter 4 of the book), from several starts.
 *
 * Without sliding friction S is symmetric, and the accelerations are unique. All contacts are then solved at once. If the
 * forces are not unique, those of least norm are taken.
 */
#include "nonsmooth/contacts/resting_forces.h"

#include <math.h>
#include <stdint.h>

#include "arithmetic.h"
#include "nonsmooth/cones/cone_search.h"
#include "support/elimination.h"
#include "support/next_random.h"

/* Operations on forces in a group, of which a step of damped compliant contacts takes n^2: about 1 ms. */
static const double most_work = 1e6;

/* Forces that grow beyond this number of free accelerations have no limit. */
static const double endless_force = 1e6;

/* S is positive definite if the pivots of its symmetric part exceed the square of this; S_ii = 1 without friction. */
static const double locking_share = 1e-3;

/* Smaller elements of S are rounding errors and couple no contacts; S is scaled to a size of 1. */
static const double least_coupling = 1e-13;

/* The compliance of contacts without friction, in units of S for the one with the largest unit. */
static const double compliance_of_contact = 1e-9;

/* Starts of exchanges before a solution counts as missing, and exchanges for each contact from a start. */
enum { STARTS = 32, EXCHANGES = 2 };

/* Half of the numbers that next_random() returns are at least this. */
static const uint32_t half_of_draws = 1u << 23;

static size_t work_count(const struct ConePath *path, size_t count) {
  return count * count + 2 * count + pressing_forces_work_count(path, count);
}

size_t resting_forces_bytes(const struct ConePath *path, size_t count) {
  return (count * count + 7 * count + work_count(path, count)) * sizeof(double) + count * sizeof(size_t);
}

struct RestingForces resting_forces_in(void *block, const struct ConePath *path, size_t count) {
  struct RestingForces resting = {.count = count, .path = path, .s = block};
  resting.free = resting.s + count * count;
  resting.present = resting.free + count;
  resting.found = resting.present + count;
  resting.found_force = resting.found + count;
  resting.force = resting.found_force + count;
  resting.motion = resting.force + count;
  resting.presses = resting.motion + count;
  resting.work = resting.presses + count;
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

/*
 * Finds the forces of all contacts at free accelerations scaled to a size of 1. Each has the same small compliance: of
 * several solutions, that of least norm is found. False if there is none, or if the compliance alone limits the forces.
 */
static bool find_least_forces(const struct RestingForces *resting, const double *unit, double size) {
  size_t n = resting->count;
  double *matrix = resting->work, *q = matrix + n * n, *z = q + n, largest = 0.0;
  for (size_t i = 0; i < n; i++) largest = fmax(largest, unit[i]);
  for (size_t i = 0; i < n; i++) {
    q[i] = size > 0.0 ? resting->free[i] / size : 0.0;
    for (size_t j = 0; j < n; j++) matrix[i * n + j] = resting->s[i * n + j];
    matrix[i * n + i] += compliance_of_contact * unit[i] * unit[i] / (largest * largest);
  }
  if (!pressing_forces_find(resting->path, n, matrix, q, z, z + n)) return false;
  bool has_limit = true;
  for (size_t i = 0; i < n; i++) {
    resting->force[i] = z[i] * size;
    has_limit &= z[i] < endless_force;
  }
  return has_limit;
}

/*
 * Follows the forces of damped compliant contacts, dF/dt = -(free + S F) with F >= 0, by Euler's steps to rest. False
 * if they do not come to rest at a solution. Stores its accelerations in motion.
 */
static bool relax_forces(const struct RestingForces *resting, double size) {
  const double rest = 1e-3 * rounded_force;
  size_t n = resting->group_count;
  double largest = 0.0, *next = resting->work, change = INFINITY, most = 0.0;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) largest = fmax(largest, fabs(between(resting, i, j)));
  double step = 1.0 / (largest * (double)n);
  for (double work = 0.0; work < most_work && change > rest * size && most < endless_force * size;
       work += (double)(n * n)) {
    change = most = 0.0;
    for (size_t i = 0; i < n; i++) {
      double rate = resting->free[resting->group[i]], force = resting->force[resting->group[i]];
      for (size_t j = 0; j < n; j++) rate += between(resting, i, j) * resting->force[resting->group[j]];
      next[i] = fmax(force - step * rate, 0.0);
      change = fmax(change, fabs(next[i] - force));
      most = fmax(most, next[i]);
    }
    for (size_t i = 0; i < n; i++) resting->force[resting->group[i]] = next[i];
  }
  return is_solution(resting, size);
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

/* Takes the present forces, each less a nudge if it presses: unstable ones fall from there. */
static void take_present(const struct RestingForces *resting, double nudge) {
  for (size_t i = 0; i < resting->group_count; i++) {
    double force = resting->present[resting->group[i]];
    resting->force[resting->group[i]] = force > nudge ? force - nudge : force;
  }
}

/* Keeps the present forces, which are a solution, unless compliance leads from them to another one. */
static enum RestingSolutions examine_present(const struct RestingForces *resting, double size) {
  take_present(resting, 0.0);
  is_solution(resting, size);
  note_solution(resting);
  take_present(resting, 1e-3 * smallest_force(resting, size));
  if (!relax_forces(resting, size)) return PERHAPS_OTHERS;
  if (is_same_motion(resting, size)) return ONE_MOTION;
  note_solution(resting);
  return OTHER_MOTION;
}

/* Finds the forces that keep a = 0 where contacts press; the others have none. False if S is singular there. */
static bool find_pressing_forces(const struct RestingForces *resting) {
  size_t n = resting->group_count, width = n + 1;
  double *a = resting->work;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++)
      a[i * width + j] = resting->presses[i] * resting->presses[j] != 0.0 ? between(resting, i, j) : i == j ? 1.0 : 0.0;
    a[i * width + n] = -resting->presses[i] * resting->free[resting->group[i]];
  }
  if (!solve_by_elimination(n, a, usual_least_pivot)) return false;
  for (size_t i = 0; i < n; i++) resting->force[resting->group[i]] = a[i * width + n];
  return true;
}

/* Exchanges the contact that pulls, or whose gap closes, most. */
static void exchange_worst(const struct RestingForces *resting) {
  size_t worst = 0;
  double most = -INFINITY;
  for (size_t i = 0; i < resting->group_count; i++) {
    size_t contact = resting->group[i];
    double violation = resting->presses[i] != 0.0 ? -resting->force[contact] : -resting->motion[contact];
    if (violation <= most) continue;
    worst = i;
    most = violation;
  }
  resting->presses[worst] = 1.0 - resting->presses[worst];
}

/* Selects the contacts that press at a start: those at present, then all, then half of them at random. */
static void choose_pressing(const struct RestingForces *resting, int start, uint32_t *random) {
  for (size_t i = 0; i < resting->group_count; i++) {
    bool is_drawn = next_random(random) >= half_of_draws;
    bool presses = start == 0 ? resting->present[resting->group[i]] > 0.0 : start == 1 || is_drawn;
    resting->presses[i] = presses ? 1.0 : 0.0;
  }
}

/* Exchanges contacts from a start. False if no solution is reached. */
static bool exchange_contacts(const struct RestingForces *resting, double size) {
  for (size_t count = 0; count <= EXCHANGES * resting->group_count; count++) {
    if (!find_pressing_forces(resting)) return false;
    if (is_solution(resting, size)) return true;
    exchange_worst(resting);
  }
  return false;
}

/* Exchanges contacts from several starts. False if no solution is reached. */
static bool search_by_exchanges(const struct RestingForces *resting, double size) {
  uint32_t random = 1;
  bool is_found = false;
  for (int start = 0; start < STARTS && !is_found; start++) {
    choose_pressing(resting, start, &random);
    is_found = exchange_contacts(resting, size);
  }
  return is_found;
}

/* Finds a solution where the present forces are none. is_one: it is the only one. */
static enum RestingSolutions find_solution(const struct RestingForces *resting, bool is_one, double size) {
  take_present(resting, 0.0);
  bool is_led = !is_one && relax_forces(resting, size);
  if (!is_led && !search_by_exchanges(resting, size)) return NO_MOTION;
  note_solution(resting);
  return is_one || is_led ? ONE_MOTION : PERHAPS_OTHERS;
}

static enum RestingSolutions solve_group(const struct RestingForces *resting, bool is_solved, double size) {
  bool is_one = is_surely_one(resting);
  if (!is_solved) return find_solution(resting, is_one, size);
  return is_one ? ONE_MOTION : examine_present(resting, size);
}

bool resting_forces_press(struct RestingForces *resting, const double *unit) {
  double size = largest_free_acceleration(resting);
  collect_all(resting);
  if (!find_least_forces(resting, unit, size)) return false;
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
    if (solutions > worst) worst = solutions;
  }
  return worst;
}
