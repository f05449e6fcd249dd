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

/* Does the elimination alone. order: the original index of each row, n numbers; NULL if no other right side follows. */
bool eliminate(size_t n, double *rows, double least_pivot, size_t *order);

/* Solves eliminated equations in O(n^2) for another right side, in the original order. solution: n numbers. */
void solve_eliminated(size_t n, const double *rows, const size_t *order, const double *right, double *solution);
