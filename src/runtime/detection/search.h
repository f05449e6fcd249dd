/* Search for events: the first time at which an indicator changes its sign (search.c). */
#pragma once

#include "instance/instance.h"

struct IntervalSamples; /* search_interval.h */

/* TO_ROUNDING: the time of the event, to rounding. BEFORE_IT: a time before the event, which costs less. */
enum Exactness { TO_ROUNDING, BEFORE_IT };

/* STAYS: f does not fall below 0. FALLS: it does so once. UNKNOWN: the interval must be halved. */
enum Verdict { STAYS, FALLS, UNKNOWN };

/* Classifies f, which is positive while the mode stays, by its values at the Chebyshev nodes (chebyshev.h). */
enum Verdict search_judge(const double *f, double error_bound);

/* Returns the number of doubles of workspace of a search, including those of search_interval_shorten(). */
size_t search_work_count(void);

/*
 * Finds the first time in [from, to], within the solver's last step, at which an indicator changes its sign. samples:
 * as search_interval_shorten() gives them for this interval. False if no indicator changes its sign. *time is NAN if
 * zeros cannot be separated.
 */
bool search_for_event(struct Instance *instance, double from, double to, const struct IntervalSamples *samples,
                      enum Exactness exactness, double *time, size_t *indicator);

/*
 * Extrapolates the state at the end of the last step along its tangent past the zero of an indicator. This serves
 * motions that cannot reach the zero, as where a root ends. The zero must be closer than tangent_share of the scales.
 * False if there is none.
 */
bool search_for_jump(struct Instance *instance, double *time, double *state, size_t *indicator);
