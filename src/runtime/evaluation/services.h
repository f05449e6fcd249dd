/* Evaluations for solvers and events at times and states of their own. */
#pragma once

#include "instance/solver.h"

/* Computes d state / dt at a time and state, with the inputs of that time; counts it. False if it does not exist. */
bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative);

/* Does the same for a state that a method tries: beyond the end of a piece without a value there, by the other piece. */
bool solver_derivatives_beyond(struct Instance *instance, double time, const double *state, double *derivative);

/* Computes the Jacobian, in the order of lagrangian.implicit.pattern; counts it. False if M is singular. */
bool solver_jacobian(struct Instance *instance, double time, const double *state, double *values);

/* Returns the evaluation point at a time and state. */
struct Point solver_point(struct Instance *instance, double time, const double *state);

/* Moves the point to another time and state, with the inputs of that time. */
void solver_move_point(struct Instance *instance, struct Point *point, double time, const double *state);

/* Computes the states at several times in the solver's last step, one row each. False if one is not available. */
bool solver_interpolate(const struct Solver *solver, struct Instance *instance, const double *times, size_t count,
                        double *states);

/* Sets the instance's state to that of a time in the last step. False if it is not available or not finite. */
bool solver_take_state(struct Instance *instance, double time);

/* True if a constraint is active: those of open contacts and of sliding frictions are not. */
bool solver_has_constraints(const struct Instance *instance);

/* Projects a state at the end of a step onto the active constraints. Returns NULL, or the reason why that fails. */
const char *solver_project(struct Instance *instance, double time, double *state);

/* Implements Solver.destroy for memory of one block. */
void solver_free_memory(struct Instance *instance);

/* Logs that memory for the solver is missing; returns false. */
bool solver_is_out_of_memory(struct Instance *instance);

/* True if a step is only a few units in the last place of the time. */
bool solver_step_vanishes(double time, double step);

/* Returns the tolerance times the smallest nominal coordinate. */
double solver_tolerance(const struct Instance *instance);

/* Returns the error that the method may make in a coordinate inside a step; 0 if rounding is the only error. */
double solver_error(const struct Instance *instance);

/* The reason that is logged if solver_step_vanishes(). */
extern const char solver_vanished_step[];
