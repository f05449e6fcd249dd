/* Windows of time in which no function in the indicators can hide between samples (window.c). */
#ifndef WINDOW_H
#define WINDOW_H

#include "instance/instance.h"

/* Return the number of doubles of workspace, and of the samples, which are its first part. */
size_t window_work_count(void);
size_t window_sample_count(void);

/*
 * Moves the end of a window in the solver's last step nearer to its start, until no function in the indicators can hide
 * between samples. False if the window is as short as time can resolve and may still hide something. *samples: the
 * states at the CHEBYSHEV_NODES of the window, a row each; NULL if they are not all available.
 */
bool window_narrow(struct Instance *instance, double from, double *to, const double **samples);

#endif
