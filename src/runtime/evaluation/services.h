/* What solvers and events ask of the system at times and states of their own. */
#ifndef SERVICES_H
#define SERVICES_H

#include "instance/solver.h"

/*
 * d state / dt at a time and state that the solver chose, with the inputs of that time; counts the evaluation.
 * False where it does not exist.
 */
bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative);

/* The Jacobian there, in the order of lagrangian.implicit.pattern; counts it. False where M is singular. */
bool solver_jacobian(struct Instance *instance, double time, const double *state, double *values);

/* The point for generated functions at a time and state that the solver chose. */
struct Point solver_point(struct Instance *instance, double time, const double *state);

/* The same at another one, for inputs that may follow the time. */
void solver_move_point(struct Instance *instance, struct Point *point, double time, const double *state);

/* The states at several times in the last step of a solver, a row each. False where one is not known. */
bool solver_interpolate(const struct Solver *solver, struct Instance *instance, const double *times, size_t count,
                        double *states);

/* The instance's state becomes that of a time in the last step. False where that is not known or not finite. */
bool solver_take_state(struct Instance *instance, double time);

/* False where there are no constraints but those of contacts that are open and of frictions that slide. */
bool solver_is_held(const struct Instance *instance);

/*
 * Brings the state at the end of a step back to the constraints, where there are some. NULL, or the reason why the
 * motion cannot go on.
 */
const char *solver_project(struct Instance *instance, double time, double *state);

/* Solver.destroy of one whose memory is one block. */
void solver_free_memory(struct Instance *instance);

/* Logs that the solver has no memory; returns false. */
bool solver_lacks_memory(const struct Instance *instance);

/* Whether a step is only a few units in the last place of the time. */
bool solver_rests(double time, double step);

/* What the method may make of a coordinate; 0 for one that errs by rounding alone. */
double solver_error(const struct Instance *instance);

/* What a user reads where a solver rests. */
extern const char solver_resting[];

#endif
