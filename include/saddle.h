/*
 * Factors the saddle-point matrix K = (M J^T; J 0), with a positive definite M, as L D L^T. It serves blocks of the
 * mass matrix with constraints. Rows are ordered so that each constraint comes after its coordinates. Then no pivoting
 * is needed: the pivots of M are positive, and those of the constraints, which are the pivots of the Schur complement
 * -J M^-1 J^T, are negative (M. Benzi, G. H. Golub, J. Liesen: Numerical solution of saddle point problems, Acta
 * Numerica 14, 2005). Constraints that depend on others are found by their pivots and left out, with force 0.
 *
 * The pattern of L is that of ldlt.h, with e elements. Without fill-in, K has g elements. column holds the e columns of
 * L, then the n + 1 numbers of start for K, and the g columns of K. With c constraints, m holds SADDLE_MASS(e, g, n, c)
 * numbers: the factors, K, the smallest relative pivot of a constraint, 2 n numbers of workspace, L without zeros, and
 * the null space of J^T, see saddle_least_forces(). Right sides are arrays of SADDLE_RIGHT_SIDE(n) numbers, of which the
 * first n are given and solved for.
 */
#ifndef SADDLE_H
#define SADDLE_H

#include <math.h>
#include <stddef.h>

#include "arithmetic.h"
#include "real.h"

/* Numbers of storage for L without zeros, for a block, and for a right side, see above. */
#define SADDLE_PACKED(elements, n) ((elements) + (n) + (elements) / 2 + 2)
#define SADDLE_MASS(elements, given, n, constraints)                                                                   \
  ((elements) + (given) + 1 + 2 * (n) + SADDLE_PACKED(elements, n) + (constraints) * ((constraints) + 1) / 2)
#define SADDLE_RIGHT_SIDE(n) (4 * (n))

/* Numbers of constraints among those of rows of K, which are positive for rows of M. */
enum {
  SADDLE_CONSTRAINT = -1,
  SADDLE_NORM = -2 /* norm of a quaternion: its force moves nothing, and has no part in the norm of forces */
};

/*
 * Computes L (below the diagonal) and D (on it) from K. coordinate: positive numbers for rows of M, negative ones for
 * constraints, see above. A constraint may depend on those before it, or its row may be 0, as that of an open contact.
 * It gets the pivot -INFINITY, so that its force is 0; a row of 0 has no elements of L then. Returns 0, or 1 + the
 * first row in which M is not positive definite.
 */
size_t saddle_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m);

/* True if a pivot of M is positive to rounding: below 1e-14 of its diagonal element it has lost all its digits. */
static inline Condition saddle_is_definite(Real pivot, Real diagonal) {
  const double smallest_share_of_mass = 1e-14;
  return pivot > smallest_share_of_mass * diagonal;
}

/*
 * Returns the contribution of a term of a constraint's pivot to J M^-1 J^T of that constraint alone: that of a row of
 * M, which is positive.
 */
static inline Real saddle_delassus(Real term) {
  return WHERE(term > 0.0, term, 0.0);
}

/*
 * True if a constraint's pivot may be wrong by rounding, and is recomputed. hold / delassus is the pivot relative to
 * that of the constraint alone, weakest the smallest such ratio before. Below 1e-14 the pivot is 0 in any case.
 * Rounding errors grow by 1 / weakest; above 1e-11 / weakest the pivot has enough digits.
 */
static inline Condition saddle_is_doubtful(Real hold, Real delassus, Real weakest) {
  const double rounding_of_share = 1e-14, rounding_by_weakest = 1e-11;
  Real share = hold / delassus, size = WHERE(share < 0.0, -share, share);
  return BOTH(size > rounding_of_share, size * weakest < rounding_by_weakest);
}

/*
 * Returns the pivot of a constraint, and updates the smallest relative one. A relative pivot is the squared sine of the
 * angle between the constraint and the span of those before it, in the metric of M^-1. Up to 1e-12 (a sine of 1e-6) the
 * constraint counts as dependent: rounding leaves less, and a regular constraint would keep no digits.
 */
static inline Real saddle_pivot(Real hold, Real delassus, Real *weakest) {
  const double smallest_share = 1e-12;
  Condition has_hold = hold > smallest_share * delassus, has_none = hold <= smallest_share * delassus;
  *weakest = WHERE(BOTH(has_hold, hold / delassus < *weakest), hold / delassus, *weakest);
  return WHERE(has_none, -INFINITY, -hold); /* NAN stays NAN */
}

/* Above this smallest relative pivot, solutions lose at most a few digits, and are not refined. */
static const double saddle_weak_share = 1e-3;

/* True if the smallest relative pivot is lower; elements is the number of those of L and K. */
static inline Condition saddle_is_weak(size_t elements, const Real *m) {
  return m[elements] < saddle_weak_share;
}

/*
 * Solves K x = b in place. Applies one step of iterative refinement if a relative pivot is small: -J M^-1 J^T squares
 * the condition number of J.
 */
void saddle_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x);

/*
 * Computes a basis of the null space of J^T, orthogonal without the forces of quaternion norms, and stores it after the
 * factors. saddle_factor() calls it.
 */
void saddle_null_vector(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m);

/*
 * Replaces the constraint forces F in x by those of least Euclidean norm with the same J^T F: a statically
 * indeterminate system with dependent constraints has many. Subtracts the components in the null space of J^T.
 */
void saddle_least_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                         Real *x);

#endif
