/* Linear complementarity problems: w = M z + q with w >= 0, z >= 0 and w^T z = 0. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Returns the number of doubles of workspace for n rows. */
size_t complementarity_work_count(size_t n);

/*
 * Solves for z[n] by Lemke's method. matrix: M by rows, n x n; M and q should be scaled to a size of 1. Of several
 * solutions it finds the one at the end of Lemke's path from z = 0. As a rule this does not depend on the order of
 * the rows. False, with z = 0, if the path ends without a solution.
 */
bool complementarity_solve(size_t n, const double *matrix, const double *q, double *z, double *work);
