/* What switching.c, event_search.c, event_passing.c and settlement.c share. */
#ifndef SWITCHING_PARTS_H
#define SWITCHING_PARTS_H

#include "events/chebyshev.h"
#include "instance/switching.h"

/* The indicators at a time and state; false where there are no accelerations, or a value is not finite. */
bool switching_indicators(struct Instance *instance, double time, const double *state, double *indicator);

/* A state that differs from another by what rounding may do to it, in one way or otherwise. */
void switching_round(const double *state, bool otherwise, double *rounded);

/* Numbers of workspace that a search needs, those of switching_narrow() among them. */
size_t switching_search_count(void);
size_t switching_window_count(void);

/*
 * Brings the end of a window of time in the solver's last step nearer to its begin until nothing that the indicators look at
 * can hide between samples. False where the window is as short as time can tell and may still hide something.
 */
bool switching_narrow(struct Instance *instance, double from, double *to);

/*
 * The first time from one on up to a later one in the solver's last step at which an indicator changes its sign. False
 * where none does. The time is NAN where its zeros cannot be told from one another.
 */
bool switching_find(struct Instance *instance, double from, double to, double *time, size_t *indicator);

/*
 * For a motion that cannot come to the zero of an indicator, as a root that ends there: takes the state at the end of the
 * last step along its tangent behind a zero that is nearer than the state's digits matter. False where there is none.
 */
bool switching_jump(struct Instance *instance, double *time, double *state, size_t *indicator);

/* The functions of the same names in struct Switching. */
bool switching_start(struct Instance *instance, const char *function);
bool switching_release(struct Instance *instance, double time);
bool switching_resume(struct Instance *instance, double time);
const char *switching_check(struct Instance *instance, double time);
bool switching_come_back(struct Instance *instance, struct Point *point);
void switching_explain(struct Instance *instance, const struct CommunicationStep *step,
                       const struct EventProgress *progress);
const char *switching_update(struct Instance *instance, bool *changed);
const char *switching_pass(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress);
const char *switching_pass_barrier(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                                   struct EventProgress *progress);

/* 1, -1 or 0: the sign that an indicator has while its mode stays; 0 of a branch that rests at 0. */
double switching_sign(const struct Instance *instance, size_t indicator);

/* How far below 0 an event may leave an indicator, in units of what rounding makes of it. */
enum { FLOOR_IN_NOISE = 64 };

#endif
