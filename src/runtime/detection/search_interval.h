/* Intervals of time in which no function in the indicators can hide between samples (search_interval.c). */
#pragma once

#include "instance/instance.h"

/*
 * Samples of an interval, a row for each of its CHEBYSHEV_NODES. states: NULL if they are not all available.
 * accelerations: with the constraint forces, if no function hides in the interval, and some may; else NULL.
 */
struct IntervalSamples {
  const double *states, *accelerations;
};

/* Return the number of doubles of workspace, and of the samples, which are its first part. */
size_t search_interval_work_count(void);
size_t search_interval_sample_count(void);

/*
 * Moves the end of an interval in the solver's last step nearer to its start, until no function in the indicators can
 * hide between samples. False if the interval is as short as time can resolve and may still hide something. *samples:
 * those of the interval.
 */
bool search_interval_shorten(struct Instance *instance, double from, double *to, struct IntervalSamples *samples);
