/* Intervals of time in which no function in the indicators can hide between samples (search_interval.c). */
#pragma once

#include "instance/instance.h"

/* Return the number of doubles of workspace, and of the samples, which are its first part. */
size_t search_interval_work_count(void);
size_t search_interval_sample_count(void);

/*
 * Moves the end of an interval in the solver's last step nearer to its start, until no function in the indicators can
 * hide between samples. False if the interval is as short as time can resolve and may still hide something. *samples:
 * the states at the CHEBYSHEV_NODES of the interval, a row each; NULL if they are not all available.
 */
bool search_interval_shorten(struct Instance *instance, double from, double *to, const double **samples);
