/* Bound of a step by the first terms of the Taylor series, for methods that need no more terms. */
#pragma once

#include "instance/solver.h"

/* Returns the rows of workspace for the state, the inputs and the series; 0 if no function limits a step. */
size_t first_terms_rows(void);

/*
 * Returns the longest step from this time and state, at most bound, in which no function in the equations can hide a
 * change (series_limit.h). rows: workspace of first_terms_rows() rows.
 */
double first_terms_step(struct Instance *instance, Series *rows, double time, const double *state, double bound);
