/*
 * K = L D L^T of a matrix (M J^T; J 0) with a positive definite M, stored as ldlt.h has it, in an order of rows in which
 * each constraint comes after its coordinates: then no pivoting is needed, and the pivots of the constraints, those of
 * -J M^-1 J^T, are negative. For blocks of the mass matrix with constraints.
 *
 * m holds the e elements of K's pattern, SADDLE_MASS(e, n, c) numbers in all with c constraints: the factors, K itself, the share
 * that is left of the weakest constraint's row, workspace, and forces that balance each other, see saddle_least_forces(). Right
 * sides are arrays of SADDLE_SIDE(n) numbers.
 */
#ifndef SADDLE_H
#define SADDLE_H

#include <math.h>
#include <stddef.h>

#include "arithmetic.h"
#include "real.h"

#define SADDLE_MASS(elements, n, constraints) (2 * (elements) + 1 + 2 * (n) + (constraints) * ((constraints) + 1) / 2)
#define SADDLE_SIDE(n) (4 * (n))

/*
 * Replaces K by L (below the diagonal) and D (on it); coordinate: positive numbers of the rows of M, negative ones of
 * constraints. A constraint that follows from those before it gets an infinite pivot, so that 0 is found for its force.
 * Returns 0, or 1 + the row in which M is not definite.
 */
size_t saddle_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m);

/* A pivot of M below this share of its diagonal element has lost all its digits. */
static inline Condition saddle_is_definite(Real pivot, Real diagonal) {
  const double smallest_share_of_mass = 1e-14;
  return pivot > smallest_share_of_mass * diagonal;
}

/* What a term of a constraint's pivot adds to its mobility, J M^-1 J^T of the constraint alone. */
static inline Real saddle_mobility(Real term) {
  return WHERE(term > 0.0, term, 0.0);
}

/*
 * Where the constraints before one have little hold, down to the share of the weakest, rounding grows into what is left of
 * it, its hold: less than the first share where those before it have much, than the second where one has the share 1 only.
 */
static inline Condition saddle_is_doubtful(Real hold, Real mobility, Real weakest) {
  const double rounding_of_share = 1e-14, rounding_by_weakest = 1e-11;
  Real share = hold / mobility, size = WHERE(share < 0.0, -share, share);
  return BOTH(size > rounding_of_share, size * weakest < rounding_by_weakest);
}

/*
 * The pivot of a constraint. One with less of its row left than this share, squared, follows from the others: what rounding
 * leaves of one that does is smaller, and one that nearly does so would have no digits left.
 */
static inline Real saddle_pivot(Real hold, Real mobility, Real *weakest) {
  const double smallest_share = 1e-12;
  Condition has_hold = hold > smallest_share * mobility, has_none = hold <= smallest_share * mobility;
  *weakest = WHERE(BOTH(has_hold, hold / mobility < *weakest), hold / mobility, *weakest);
  return WHERE(has_none, -INFINITY, -hold); /* what is no number stays none */
}

/* Solutions keep most of their digits where the weakest constraint has more than this share. */
static const double saddle_weak_share = 1e-3;

/* Whether one has less; m holds so many elements of factors. */
static inline Condition saddle_is_weak(size_t elements, const Real *m) {
  return m[2 * elements] < saddle_weak_share;
}

/*
 * Solves K x = b in place. Where a constraint has little hold, the solution is refined: -J M^-1 J^T has lost twice the
 * digits that K has lost.
 */
void saddle_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x);

/* Finds what saddle_least_forces() needs behind the factors; saddle_factor() does so itself. */
void saddle_balance(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m);

/*
 * Where constraints follow from others, many forces F have the same J^T F. Replaces those in x by the ones among them of
 * least Euclidean norm.
 */
void saddle_least_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                         Real *x);

#endif
