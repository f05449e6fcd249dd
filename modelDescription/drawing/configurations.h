/* The system where it starts, and where it may be else: values of all nodes, with coordinates that fulfil the constraints. */
#ifndef CONFIGURATIONS_H
#define CONFIGURATIONS_H

#include <stdbool.h>

#include "mechanics/equations.h"

/* Of constraints on more coordinates than this, drawings take no notice. */
enum { MOST_COORDINATES = 200 };

/* The derivatives of a node by the coordinates, one each. */
Node *slopes_of(const struct Model *model, Node node);

/*
 * The values of all nodes at the start, with the coordinates moved there by offsets (NULL for none) and then back, by as little as
 * it takes, to where the constraints are fulfilled. NULL where that fails.
 */
double *values_at(const struct Model *model, const struct Equations *equations, const double *offsets);

/*
 * Solves matrix x = x of n rows, by Gauss; the matrix is lost. Rows that follow from others, as in closed chains with a constraint too
 * many, leave 0 in the solution.
 */
void solve_small(size_t n, double *matrix, double *x);

#endif
