/*
 * Where an indicator leaves its sign. In a window of time that hides nothing (window.h) it is held against its
 * Chebyshev polynomial of degree 8: where the coefficients say that it cannot come to 0, or falls throughout, that is known;
 * else each half of the window is looked at, with new values. So two zeros that lie close, or one at the very start, are
 * found as well, whatever the solver.
 */
#ifndef SEARCH_H
#define SEARCH_H

#include "instance/instance.h"

/* A time is that of the event to rounding, or one at which it has not happened yet, which takes less. */
enum Exactness { TO_ROUNDING, BEFORE_IT };

/* Numbers of workspace that a search needs, those of window_narrow() among them. */
size_t search_work_count(void);

/*
 * The first time from one on up to a later one in the solver's last step at which an indicator changes its sign; samples: as
 * window_narrow() gives them for this window; lifted: of a contact that has just opened without speed, whose gap may fall
 * by the errors of the method, NULL for none. False where none does. The time is NAN where its zeros cannot be told from one
 * another in many smaller windows.
 */
bool search_for_event(struct Instance *instance, double from, double to, const double *samples, const size_t *lifted,
                      enum Exactness exactness, double *time, size_t *indicator);

/*
 * For a motion that cannot come to the zero of an indicator, as a root that ends there: takes the state at the end of the
 * last step along its tangent behind a zero that is nearer than the state's digits matter. False where there is none.
 */
bool search_for_jump(struct Instance *instance, double *time, double *state, size_t *indicator);

#endif
