/*
 * Solves K x = b with a nonsymmetric K = (M J^T; J 0) + C E^T, by the Woodbury identity. It is needed for forces that
 * depend on constraint forces, such as the friction of a sliding contact. C has n rows and r columns, one for each
 * force that others depend on; E^T selects these forces from x. With the symmetric S = (M J^T; J 0)^-1, factored by
 * saddle.h,
 *
 *  K^-1 = S - S C (1 + E^T S C)^-1 E^T S.
 *
 * Columns of C without effect take no part: those of 0, and those of forces whose row of J is 0, as of open contacts.
 * With a others, the a by a matrix is factored by Gaussian elimination with row pivoting. A factorization costs a
 * solutions with S more than that of saddle.h. Reference: G. H. Golub, C. F. Van Loan: Matrix Computations, section 2.1.
 *
 * coordinate[] has the n numbers of saddle.h, then r and the r rows of these forces. m has the numbers of saddle.h,
 * then NONSYMMETRIC_MASS(n, r) numbers: C by columns, and workspace.
 */
#ifndef NONSYMMETRIC_H
#define NONSYMMETRIC_H

#include <stddef.h>

#include "arithmetic.h"

/* Numbers of storage after those of saddle.h, see above. */
#define NONSYMMETRIC_MASS(n, r) (2 * (n) * (r) + (r) * (r) + 2 * (r) + 1 + 4 * (n))

/* Do the same as those of saddle.h. nonsymmetric_factor() also returns 1 if 1 + E^T S C is singular: friction jams. */
size_t nonsymmetric_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, double *m);
void nonsymmetric_solve(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                        double *x);

#endif
