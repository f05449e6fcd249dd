/* What the solvers of SUNDIALS share. */
#ifndef SUNDIALS_SUPPORT_H
#define SUNDIALS_SUPPORT_H

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include "instance.h"

/* Vectors of a solver. */
struct SundialsVectors {
  SUNContext context;
  N_Vector state, tolerance; /* tolerance: absolute, by state */
  double relative;           /* tolerance */
  Series *series;            /* of the state, the inputs and the workspace; NULL where nothing limits a step */
};

/* False after logging where SUNDIALS has no memory. */
bool sundials_vectors_create(struct Instance *instance, struct SundialsVectors *vectors);
void sundials_vectors_destroy(const struct Instance *instance, struct SundialsVectors *vectors);

/* Sets the tolerances for the solver: its local errors add up over a simulation. */
void sundials_set_tolerances(const struct Instance *instance, struct SundialsVectors *vectors, double safety);

/*
 * How far a step from a time and state may go, at most to the bound, without passing over what a function in the
 * equations hides there, by the first terms of their Taylor series (series_limit.h).
 */
double sundials_longest_step(struct Instance *instance, const struct SundialsVectors *vectors, double time,
                             const double *state, double bound);

/* Logs that a call of SUNDIALS failed unless flag tells success; returns whether it succeeded. */
bool sundials_succeeded(const struct Instance *instance, int flag, const char *call);

/*
 * Advances by a step that is too short for the solver, a few units in the last place of the time, where Euler's
 * method is exact to rounding. False where the step is longer or the derivative does not exist.
 */
bool sundials_tiny_step(struct Instance *instance, double end);

/* Logs that the solver stopped before the end of a communication step, why, and what to try. */
void sundials_log_stop(struct Instance *instance, const char *solver, const char *reason, double reached, double end);

/* An error handler for SUNDIALS that stays silent: the flags tell what happened, in this project's words. */
void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data);

enum { STEP_LIMIT = 10000000 }; /* internal steps in one communication step */

/* SUNDIALS goes on where its steps are too short to change the time, and so passes through singularities. */
enum { RESTING_STEP_LIMIT = 20 };
extern const char resting_steps[]; /* the reason that a user reads */

/* Whether a step is only a few units in the last place of the time. */
bool sundials_rests(double time, double step);

#endif
