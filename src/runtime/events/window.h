/*
 * A window of time in which what the indicators look at hides nothing: a hill exp(-(x/w)^2), flat where a window begins, has
 * no sample on it. Along the polynomials of the solver's last step, of whatever method, each elementary function is bounded
 * over the disc about the middle of the window, as series_limit.h does it for steps.
 */
#ifndef WINDOW_H
#define WINDOW_H

#include "instance/instance.h"

/* Numbers of workspace that this needs, and those of them that its samples are in, which come first. */
size_t window_work_count(void);
size_t window_sample_count(void);

/*
 * Brings the end of a window of time in the solver's last step nearer to its beginning until nothing that the indicators look at
 * can hide between samples. False where the window is as short as time can tell and may still hide something. *samples:
 * the states at the CHEBYSHEV_NODES of the window, a row each; NULL where they are not all known.
 */
bool window_narrow(struct Instance *instance, double from, double *to, const double **samples);

#endif
