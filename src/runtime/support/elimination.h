/* Solution of small linear systems. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The least pivot of equations that are regular or clearly singular. */
static const double usual_least_pivot = 1e-11;

/*
 * Solves n equations by elimination with row pivoting, in O(n^3). Each of the n rows has n + 1 numbers,
 * the last one its right side, which the solution replaces. The matrix should be scaled to a size of 1. False if a
 * pivot is at most least_pivot, and so counts as 0.
 */
bool solve_by_elimination(size_t n, double *rows, double least_pivot);
