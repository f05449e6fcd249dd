/* Linear complementarity problems: w = M z + q with w >= 0, z >= 0, and for each row one of both 0. */
#ifndef COMPLEMENTARITY_H
#define COMPLEMENTARITY_H

#include <stdbool.h>
#include <stddef.h>

/* Numbers of workspace for n rows. */
size_t complementarity_work_count(size_t n);

/*
 * z of M, n rows of it, and q. Of several solutions that which Lemke's method comes to from z = 0, as a rule whatever the
 * order of the rows; their numbers should be of the size of 1. False where it comes to none.
 */
bool complementarity_solve(size_t n, const double *matrix, const double *q, double *z, double *work);

#endif
