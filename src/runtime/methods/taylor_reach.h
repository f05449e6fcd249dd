/* How long a step of the Taylor solver may be. */
#ifndef TAYLOR_REACH_H
#define TAYLOR_REACH_H

#include "methods/taylor.h"

/*
 * d state / dt at a time and at the state that instance->work holds, and the first coefficients of all series. Returns
 * what lagrangian.taylor.start returns.
 */
int taylor_start(struct Instance *instance, const struct Taylor *taylor, double time, double *derivative);

/* Sets taylor->unit by the state at the origin. */
void taylor_measure_scales(struct Taylor *taylor);

/*
 * Sets the reach of the series that taylor->x holds: as long as its last coefficients promise, but no longer than the
 * functions in the equations allow (series_limit.h), and so that the polynomials were found to obey the equations of
 * motion at its end. 0 where no step can be taken.
 */
void taylor_choose_reach(struct Instance *instance, struct Taylor *taylor, double communication_step);

#endif
