/* Parts that the solvers of SUNDIALS share. */
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include "instance/solver.h"
#include "methods/sundials/sundials_memory.h"

/* First member of the memory of each solver. */
struct Sundials {
  struct SundialsMemory memory;
  SUNContext context;
  N_Vector state;     /* at the end of the last step */
  N_Vector inside;    /* workspace: a state inside the last step */
  N_Vector tolerance; /* absolute, one for each state */
  double relative;    /* relative tolerance */
  Series *series;     /* workspace of first_terms.h; NULL if no function limits a step */
};

/* Allocates solver_memory of size bytes and calls configure. False if that fails. */
bool sundials_create(struct Instance *instance, size_t size, bool (*configure)(struct Instance *instance));

/* Takes over the state, and sets the tolerances to safety times that of the simulation: errors of many steps add up. */
void sundials_load(const struct Instance *instance, const double *state, double safety);

/* Computes d state / dt, for SUNDIALS; the instance is its user data. */
int sundials_right_side(realtype time, N_Vector state, N_Vector derivative, void *instance);

/* Implements Solver.interpolate by evaluate, SUNDIALS' dense output of the last step for its memory. */
bool sundials_interpolate(struct Instance *instance,
                          int (*evaluate)(void *memory, realtype time, int order, N_Vector y), void *memory,
                          double time, double *state);

/*
 * Returns the longest step from this time and the solver's state, at most bound. No function in the equations can
 * hide a change in it (first_terms.h).
 */
double sundials_longest_step(struct Instance *instance, double time, double bound);

/* True if flag reports success; otherwise logs the failed call. */
bool sundials_succeeded(const struct Instance *instance, int flag, const char *call);
#define SUCCEEDS(instance, function, ...) sundials_succeeded(instance, function(__VA_ARGS__), #function)

/*
 * Takes the rest of a communication step by Euler's method if it is a few units in the last place of the time. That
 * is exact to rounding, and too short for the solver. False if it is longer, or if the derivative does not exist.
 */
bool sundials_tiny_step(struct Instance *instance, const struct CommunicationStep *step);

/* Ignores errors, as the handler of SUNDIALS: the callers report them by the returned flags. */
void sundials_ignore_error(int code, const char *module, const char *function, char *message, void *data);
