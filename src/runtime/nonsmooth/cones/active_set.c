/*
 * Active set method for impulses p of contacts without friction: with u = rate + W p, for each contact
 *
 *   u >= 0,   p >= 0,   u p = 0.
 *
 * W = J M^-1 J^T is symmetric and positive semidefinite, and rate = J v. So these are the conditions of the least
 * squares problem
 *
 *   min 1/2 p^T W p + rate^T p   over p >= 0,
 *
 * which has a solution. The method is that of C. L. Lawson and R. J. Hanson (Solving Least Squares Problems, 1974,
 * chapter 23). The contact that closes fastest joins the set of those that press. On this set u = 0 is solved. If an
 * impulse becomes negative, the impulses go up to its zero, it leaves the set, and the rest is solved again. Each
 * solution of a set has a smaller minimum than the one before. So no set comes twice, and the method ends.
 * A solution costs O(n^3), and usually there are about as many as contacts that press.
 *
 * Unlike sweeps and Newton's method, it solves problems near singularity. An example is a ball that is wedged between
 * others in a row from wall to wall. A contact that depends on the set is left out until the impulses change.
 */
#include "nonsmooth/cones/active_set.h"

#include <float.h>
#include <math.h>

#include "support/arena.h"
#include "support/elimination.h"

/* Solutions for each contact, after which rounding must have brought a set back. */
enum { SOLUTIONS_OF_CONTACT = 10 };

/*
 * A contact depends on the set if its pivot is smaller. Gaps count as closed up to 1e-12 of a length (tolerances.h).
 * Their directions are uncertain by the square root of that, and elements of W by its square.
 */
static const double least_pivot = 1e-12;

/* Relative to the diagonal: larger differences of elements of W from their transposed ones are those of friction. */
static const double symmetric_share = 1e-9;

/* A contact: OUT does not press, IN does; LEFT_ASIDE depends on others. */
enum Member { OUT, IN, LEFT_ASIDE };

/* Rows are scaled such that W_ii = 1. */
struct ActiveSet {
  struct Cones *cones;
  size_t n, count; /* count: size of the set */
  double *impulse; /* scaled: of kinetic energy to the power 1/2 */
  double *matrix;  /* count rows of count + 1 elements: workspace */
  double *solution;
  size_t *index; /* the contacts of the set */
  enum Member *member;
};

static size_t lay_out_set(struct ActiveSet *set, size_t n, double *work) {
  struct Arena arena = {(uintptr_t)work};
  ARENA_NUMBERS(&arena, n, &set->impulse, &set->solution);
  ARENA_NUMBERS(&arena, n * (n + 1), &set->matrix);
  ARENA_TAKE(&arena, set->index, n);
  ARENA_TAKE(&arena, set->member, n);
  return (arena.next - (uintptr_t)work + sizeof(double) - 1) / sizeof(double);
}

size_t active_set_work_count(size_t n) {
  struct ActiveSet set;
  return lay_out_set(&set, n, NULL);
}

bool active_set_applies(const struct Cones *cones) {
  size_t n = cones->impulses->count;
  const double *w = cones->impulses->delassus;
  bool is_symmetric = n == cones->impulses->contact_count;
  for (size_t i = 0; i < n && is_symmetric; i++)
    for (size_t j = 0; j < i; j++)
      is_symmetric &= fabs(w[i * n + j] - w[j * n + i]) <= symmetric_share * sqrt(w[i * n + i] * w[j * n + j]);
  return is_symmetric;
}

static double scaled_element(const struct ActiveSet *set, size_t i, size_t j) {
  const double *w = set->cones->impulses->delassus, *scale = set->cones->scale;
  return w[i * set->n + j] / sqrt(scale[i] * scale[j]);
}

static double scaled_rate(const struct ActiveSet *set, size_t contact) {
  return set->cones->rate[contact] / sqrt(set->cones->scale[contact]);
}

/* Returns the scaled rate after the impact, or 0 if it is a rounding error of its terms. */
static double rate_behind(const struct ActiveSet *set, size_t contact) {
  double rate = scaled_rate(set, contact), size = fabs(rate);
  for (size_t j = 0; j < set->n; j++) {
    double term = scaled_element(set, contact, j) * set->impulse[j];
    rate += term;
    size += fabs(term);
  }
  return fabs(rate) > (double)set->n * DBL_EPSILON * size ? rate : 0.0;
}

/* Returns the contact outside of the set that closes fastest; n for none. */
static size_t find_closing(const struct ActiveSet *set) {
  size_t found = set->n;
  double fastest = 0.0;
  for (size_t i = 0; i < set->n; i++) {
    double rate = set->member[i] == OUT ? rate_behind(set, i) : 0.0;
    if (!(rate < fastest)) continue;
    fastest = rate;
    found = i;
  }
  return found;
}

/* Finds the impulses of the set with u = 0. False if they are not determined. */
static bool solve_set(struct ActiveSet *set) {
  set->count = 0;
  for (size_t i = 0; i < set->n; i++)
    if (set->member[i] == IN) set->index[set->count++] = i;
  size_t width = set->count + 1;
  for (size_t i = 0; i < set->count; i++) {
    size_t row = set->index[i];
    for (size_t j = 0; j < set->count; j++) set->matrix[i * width + j] = scaled_element(set, row, set->index[j]);
    set->matrix[i * width + set->count] = -scaled_rate(set, row);
  }
  if (!solve_by_elimination(set->count, set->matrix, least_pivot)) return false;
  for (size_t i = 0; i < set->count; i++) set->solution[i] = set->matrix[i * width + set->count];
  return true;
}

/* Goes to the solution, or up to the first impulse that vanishes, whose contact leaves the set. True at the solution. */
static bool go_to_solution(struct ActiveSet *set) {
  double share = 1.0;
  size_t first = set->count;
  for (size_t i = 0; i < set->count; i++) {
    double before = set->impulse[set->index[i]], change = set->solution[i] - before;
    if (!(set->solution[i] <= 0.0) || before > -share * change) continue;
    share = before / -change;
    first = i;
  }
  for (size_t i = 0; i < set->count; i++) {
    double *impulse = &set->impulse[set->index[i]];
    *impulse = fmax(*impulse + share * (set->solution[i] - *impulse), 0.0);
  }
  if (first == set->count) return true;
  set->impulse[set->index[first]] = 0.0;
  set->member[set->index[first]] = OUT;
  return false;
}

/* Lets a contact press with the set. False if it depends on the set. */
static bool let_press(struct ActiveSet *set, size_t contact, int *solutions) {
  set->member[contact] = IN;
  for (bool is_done = false; !is_done && *solutions > 0; --*solutions) {
    if (!solve_set(set)) {
      set->member[contact] = LEFT_ASIDE;
      return false;
    }
    is_done = go_to_solution(set);
  }
  return true;
}

void active_set_find(struct Cones *cones, double *work) {
  struct ActiveSet set = {.cones = cones, .n = cones->impulses->count};
  lay_out_set(&set, set.n, work);
  for (size_t i = 0; i < set.n; i++) {
    set.impulse[i] = 0.0;
    set.member[i] = OUT;
  }
  int solutions = SOLUTIONS_OF_CONTACT * (int)set.n;
  for (size_t contact = find_closing(&set); contact < set.n && solutions > 0; contact = find_closing(&set)) {
    if (!let_press(&set, contact, &solutions)) continue;
    for (size_t i = 0; i < set.n; i++)
      if (set.member[i] == LEFT_ASIDE) set.member[i] = OUT;
  }
  for (size_t i = 0; i < set.n; i++) cones->impulse[i] = set.impulse[i] / sqrt(cones->scale[i]);
}
