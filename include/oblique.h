/*
 * Forces that act on a system without being those of a constraint alone, as the friction of a contact that slides: then
 * K = (M J^T + C; J 0) is not symmetric. C has few columns, those of the forces that others follow from, so that the factors
 * of the symmetric matrix serve: K^-1 = S - S C (1 + E^T S C)^-1 E^T S with S = (M J^T; J 0)^-1, and E^T picks these forces.
 *
 * coordinate goes on behind the n numbers of saddle.h: how many columns C has, r, and the row of each one's force. m goes on
 * behind the numbers of saddle.h with C, n numbers a column, then workspace: OBLIQUE_MASS(n, r) numbers.
 */
#ifndef OBLIQUE_H
#define OBLIQUE_H

#include <stddef.h>

#include "arithmetic.h"

#define OBLIQUE_MASS(n, r) (2 * (n) * (r) + (r) * (r) + (r) + 4 * (n))

/* The same as those of saddle.h. */
size_t oblique_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, double *m);
void oblique_solve(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                   double *x);

#endif
