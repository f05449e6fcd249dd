/* Step size of the Taylor method. */
#pragma once

#include "methods/taylor.h"

/*
 * Evaluates d state / dt at a time, at the state in instance->work, and the coefficients of order 1 of all series.
 * Returns the result of lagrangian.taylor.start: 0, or 1 + the singular coordinate.
 */
int taylor_start(const struct Taylor *taylor, double time, double *derivative);

/*
 * Sets the step of the series in taylor->step (saved->interval), as described in taylor_interval.c; 0 if no step is
 * possible. communication_step: in s, > 0.
 */
void taylor_choose_interval(struct Instance *instance, struct Taylor *taylor, double communication_step);
