/* Small systems of linear equations, of which many are tried. */
#ifndef ELIMINATION_H
#define ELIMINATION_H

#include <stdbool.h>
#include <stddef.h>

/*
 * The solution takes the place of the right sides, which are the last of the n + 1 numbers of each of the n rows. False where
 * the matrix, whose numbers are to be of the size of 1, is singular.
 */
bool solve_by_elimination(size_t n, double *rows);

#endif
