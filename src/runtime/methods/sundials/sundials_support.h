/* What the solvers of SUNDIALS share. */
#ifndef SUNDIALS_SUPPORT_H
#define SUNDIALS_SUPPORT_H

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include "instance/solver.h"
#include "methods/sundials/sundials_memory.h"

/* The memory of each solver begins with this. */
struct Sundials {
  struct SundialsMemory memory;
  SUNContext context;
  N_Vector state;     /* at the end of the last step */
  N_Vector inside;    /* workspace: a state in the last step */
  N_Vector tolerance; /* absolute, by state */
  double relative;    /* tolerance */
  Series *series;     /* of the state, the inputs and the workspace; NULL where nothing limits a step */
};

/* Allocates solver_memory of this size and lets the solver configure itself; false after logging where that fails. */
bool sundials_create(struct Instance *instance, size_t size, bool (*configure)(struct Instance *instance));

/* Takes over the state and the tolerance of the situation, this share of it: local errors add up over a simulation. */
void sundials_load(const struct Instance *instance, const double *state, double safety);

/* d state / dt; a function for SUNDIALS, with the instance as its user data. */
int sundials_right_side(realtype time, N_Vector state, N_Vector derivative, void *instance);

/* Solver.interpolate, by a function of SUNDIALS that evaluates the last step of a memory of its own. */
bool sundials_interpolate(struct Instance *instance,
                          int (*evaluate)(void *memory, realtype time, int order, N_Vector y), void *memory,
                          double time, double *state);

/*
 * How far a step from a time and the state there may go, at most to the bound, without passing over what a function in
 * the equations hides there, by the first terms of their Taylor series (series_limit.h).
 */
double sundials_longest_step(struct Instance *instance, double time, double bound);

/* Logs that a call of SUNDIALS failed unless flag tells success; returns whether it succeeded. */
bool sundials_succeeded(const struct Instance *instance, int flag, const char *call);
#define SUCCEEDS(instance, function, ...) sundials_succeeded(instance, function(__VA_ARGS__), #function)

/*
 * Takes the rest of a communication step that is too short for the solver, a few units in the last place of the time, where Euler's
 * method is exact to rounding. False where the step is longer or the derivative does not exist.
 */
bool sundials_tiny_step(struct Instance *instance, const struct CommunicationStep *step);

/* An error handler for SUNDIALS that stays silent: the flags tell what happened, in this project's words. */
void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data);

#endif
