/* Solution of small linear systems. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/*
 * Solves n equations by Gauss-Jordan elimination with row pivoting, in O(n^3). Each of the n rows has n + 1 numbers,
 * the last one its right side, which the solution replaces. The matrix should be scaled to a size of 1. False if a
 * pivot counts as 0.
 */
bool solve_by_elimination(size_t n, double *rows);
