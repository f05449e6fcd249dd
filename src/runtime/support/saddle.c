#include "saddle.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "ldlt.h"

/* A pivot of M below this share of its diagonal element has lost all its digits. */
static const double smallest_share_of_mass = 1e-14;

/*
 * A constraint with less of its row left than this share, squared, follows from the others: what rounding leaves of one
 * that does is smaller, and one that nearly does so would have no digits left.
 */
static const double smallest_share = 1e-12;

/* What rounding may make of such a share where those before it have much hold, and where one of them has the share 1 only. */
static const double rounding_of_share = 1e-14, rounding_by_weakest = 1e-11;

/* What a step takes from the forces, squared, as a share of what it leaves, when it is rounding. */
static const double rounding_of_forces = 1e-32;

static Real positive(Real value) {
  return WHERE(value > 0.0, value, 0.0);
}

/* rest -= K x */
static void subtract_product(size_t n, const size_t *start, const size_t *column, const Real *matrix, const Real *x,
                             Real *rest) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = start[i]; k < start[i + 1]; k++) {
      size_t j = column[k];
      rest[i] -= matrix[k] * x[j];
      if (i != j) rest[j] -= matrix[k] * x[i];
    }
}

/* x = L^-T e_i, of the rows up to i. */
static void combine(const size_t *start, const size_t *column, const Real *m, size_t i, Real *x) {
  memset(x, 0, i * sizeof *x);
  x[i] = REAL(1.0);
  for (size_t row = i + 1; row-- > 0;)
    for (size_t k = start[row]; k + 1 < start[row + 1]; k++) x[column[k]] -= m[k] * x[row];
}

/* w^T M w of the coordinates before row i. */
static Real square_by_mass(const size_t *start, const size_t *column, const int *coordinate, const Real *matrix,
                           size_t i, const Real *w) {
  Real sum = REAL(0.0);
  for (size_t row = 0; row < i; row++)
    for (size_t k = start[row]; coordinate[row] > 0 && k < start[row + 1]; k++)
      if (coordinate[column[k]] > 0) sum += (column[k] == row ? 1.0 : 2.0) * w[row] * matrix[k] * w[column[k]];
  return sum;
}

/*
 * The pivot of constraint i with another sign, as the square of the motion w that the constraint and those before it leave
 * each other: it has the digits of w, where the pivot is a difference of squares, and w is refined.
 */
static Real hold_of(const size_t *start, const size_t *column, const int *coordinate, const Real *m, const Real *matrix,
                    size_t i, Real *w) {
  Real *rest = w + i + 1;
  combine(start, column, m, i, w);
  memset(rest, 0, (i + 1) * sizeof *rest);
  subtract_product(i + 1, start, column, matrix, w, rest);
  ldlt_solve(i, start, column, m, rest);
  for (size_t row = 0; row < i; row++) w[row] += rest[row];
  return square_by_mass(start, column, coordinate, matrix, i, w);
}

/* Where those before it have little hold, rounding grows into what is left of a constraint. */
static Condition is_doubtful(Real share, Real weakest) {
  return BOTH(fabs(share) > rounding_of_share, fabs(share) * weakest < rounding_by_weakest);
}

/* Whether a constraint has a row: that of an open contact has none, and takes part in nothing. */
static Condition has_row(const size_t *start, const Real *m, size_t i) {
  Real sum = REAL(0.0);
  for (size_t k = start[i]; k + 1 < start[i + 1]; k++) sum += fabs(m[k]);
  return sum != 0.0;
}

size_t saddle_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m) {
  Real *matrix = m + start[n], *weakest = matrix + start[n], *work = weakest + 1;
  memcpy(matrix, m, start[n] * sizeof *m);
  *weakest = REAL(1.0);
  for (size_t i = 0; i < n; i++) {
    size_t last = start[i + 1] - 1;
    if (coordinate[i] < 0 && !ANYWHERE(has_row(start, m, i))) {
      m[last] = REAL(-INFINITY);
      continue;
    }
    Real diagonal = m[last], pivot = diagonal, mobility = REAL(0.0); /* J M^-1 J^T of the constraint alone */
    for (size_t k = start[i]; k < last; k++)
      if (!ldlt_is_idle(m[start[column[k] + 1] - 1])) m[k] -= ldlt_product_of_rows(start, column, m, i, k);
    for (size_t k = start[i]; k < last; k++) {
      Real l = m[k] / m[start[column[k] + 1] - 1], term = l * m[k];
      pivot -= term;
      mobility += positive(term);
      m[k] = l;
    }
    if (coordinate[i] > 0) {
      REQUIRE(pivot > smallest_share_of_mass * diagonal, i + 1);
      m[last] = pivot;
      continue;
    }
    Real hold = -pivot;
    Condition doubts = is_doubtful(hold / mobility, *weakest);
    if (ANYWHERE(doubts)) hold = WHERE(doubts, hold_of(start, column, coordinate, m, matrix, i, work), hold);
    Condition has_hold = hold > smallest_share * mobility, has_none = hold <= smallest_share * mobility;
    m[last] = WHERE(has_none, -INFINITY, -hold); /* what is no number stays none */
    *weakest = WHERE(BOTH(has_hold, hold / mobility < *weakest), hold / mobility, *weakest);
  }
  return 0;
}

void saddle_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x) {
  Real *rest = x + n;
  Condition is_weak = saddle_is_weak(start[n], m);
  bool is_refined = ANYWHERE(is_weak);
  if (is_refined) memcpy(rest, x, n * sizeof *rest);
  ldlt_solve(n, start, column, m, x);
  if (!is_refined) return;
  subtract_product(n, start, column, m + start[n], x, rest);
  ldlt_solve(n, start, column, m, rest);
  for (size_t i = 0; i < n; i++) x[i] = WHERE(is_weak, x[i] + rest[i], x[i]);
}

/*
 * For each constraint r that follows from others, L^-T e_r holds forces that balance each other: a column of N, whose
 * columns are all F with J^T F = 0.
 */
static Condition is_redundant(const size_t *start, const Real *m, size_t i) {
  return m[start[i + 1] - 1] == -INFINITY;
}

/* rest = N^T forces, in the rows of the constraints that follow; returns the square of its length. */
static Real project_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                           const Real *forces, Real *rest) {
  Real square = REAL(0.0);
  for (size_t i = 0; i < n; i++) {
    rest[i] = coordinate[i] < 0 ? forces[i] : REAL(0.0);
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) rest[i] -= m[k] * rest[column[k]];
    square += WHERE(is_redundant(start, m, i), rest[i] * rest[i], 0.0);
  }
  return square;
}

/* rest = N direction, in the rows of all constraints; returns the square of its length. */
static Real spread_direction(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                             const Real *direction, Real *rest) {
  Real square = REAL(0.0);
  for (size_t i = 0; i < n; i++) rest[i] = WHERE(is_redundant(start, m, i), direction[i], 0.0);
  for (size_t i = n; i-- > 0;) {
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) rest[column[k]] -= m[k] * rest[i];
    if (coordinate[i] < 0) square += rest[i] * rest[i];
  }
  return square;
}

/*
 * Takes from the forces what they have along N direction, which is the rest. Returns the square of what was taken as a
 * share of what is left: whatever rounding has made of the direction, the forces do not grow.
 */
static Real take_along(size_t n, const int *coordinate, Real length, const Real *rest, Real *forces) {
  Real product = REAL(0.0), left = REAL(0.0);
  for (size_t i = 0; i < n; i++)
    if (coordinate[i] < 0) product += rest[i] * forces[i];
  Real share = WHERE(length > 0.0, product / length, 0.0);
  for (size_t i = 0; i < n; i++) {
    if (coordinate[i] >= 0) continue;
    forces[i] -= share * rest[i];
    left += forces[i] * forces[i];
  }
  return share * product / left;
}

/*
 * The conjugate gradient method for least squares |F - N y|: in exact numbers it takes a step a column at most. A direction
 * of 0, where it has ended, takes nothing.
 */
static void shorten_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                           Real steps, Real *x) {
  Real *direction = x + n, *rest = direction + n;
  Real square = project_forces(n, start, column, coordinate, m, x, rest);
  memcpy(direction, rest, n * sizeof *direction);
  for (double step = 0.0;; step += 1.0) {
    Condition goes_on = BOTH(steps > step, square > 0.0);
    if (!ANYWHERE(goes_on)) return;
    for (size_t i = 0; i < n; i++) direction[i] = WHERE(goes_on, direction[i], 0.0);
    Real length = spread_direction(n, start, column, coordinate, m, direction, rest);
    Real taken = take_along(n, coordinate, length, rest, x);
    Real before = square;
    square = project_forces(n, start, column, coordinate, m, x, rest);
    square = WHERE(BOTH(goes_on, taken > rounding_of_forces), square, 0.0);
    for (size_t i = 0; i < n; i++) direction[i] = rest[i] + square / before * direction[i];
  }
}

/* Gives the forces in x the load J^T F of others. */
static void carry_load(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                       const Real *others, Real *x) {
  Real *missing = x + n, *load = missing + n;
  for (size_t i = 0; i < n; i++) {
    missing[i] = coordinate[i] < 0 ? x[i] - others[i] : REAL(0.0);
    load[i] = REAL(0.0);
  }
  subtract_product(n, start, column, m + start[n], missing, load);
  for (size_t i = 0; i < n; i++) missing[i] = coordinate[i] < 0 ? REAL(0.0) : load[i];
  saddle_solve(n, start, column, m, missing);
  for (size_t i = 0; i < n; i++)
    if (coordinate[i] < 0) x[i] += missing[i];
}

/* N balances only as well as the constraints before those that follow have hold: what it spoils is mended once. */
void saddle_least_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                         Real *x) {
  Real *given = x + 3 * n, steps = REAL(0.0), rows = REAL(0.0);
  for (size_t i = 0; i < n; i++) {
    steps += WHERE(is_redundant(start, m, i), 3.0, 0.0);
    rows += WHERE(BOTH(is_redundant(start, m, i), has_row(start, m, i)), 1.0, 0.0);
  }
  if (!ANYWHERE(rows > 0.0)) return;
  memcpy(given, x, n * sizeof *given);
  shorten_forces(n, start, column, coordinate, m, steps, x);
  carry_load(n, start, column, coordinate, m, given, x);
  shorten_forces(n, start, column, coordinate, m, steps, x);
}
