/* How far a step may go by the first terms of the Taylor series, for methods that need no more of them. */
#ifndef FIRST_TERMS_H
#define FIRST_TERMS_H

#include "instance/solver.h"

/* Rows of workspace: of the state, the inputs and the series; 0 where nothing limits a step. */
size_t first_terms_rows(void);

/*
 * How far a step from a time and the state there may go, at most to the bound, without passing over what a function in
 * the equations hides there (series_limit.h). rows: first_terms_rows() of workspace.
 */
double first_terms_step(struct Instance *instance, Series *rows, double time, const double *state, double bound);

#endif
