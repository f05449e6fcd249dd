/* Evaluation of the generated functions at the instance's time and state. */
#pragma once

#include <math.h>

#include "instance/instance.h"

/* True if all of value[count] are finite: infinities and NaN leave a NaN in the sum. */
static inline bool are_finite(const double *value, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += value[i] - value[i];
  return sum == 0.0;
}

/* Returns the scale of a state: its absolute value, at least its nominal value. */
static inline double scale_of(const double *state, size_t i) {
  return fmax(fabs(state[i]), lagrangian.steps.nominal[i]);
}

/* Returns the largest scale of the coordinates (first = 0), or of the velocities (first = coordinate_count). */
static inline double largest_scale(const double *state, size_t first) {
  double scale = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) scale = fmax(scale, scale_of(state, first + i));
  return scale;
}

/* Returns the name of the variable with this kind and index; "" for none. */
const char *evaluate_name(enum VariableKind kind, size_t index);

/* Returns the element of the constraint in messages: "constraint", "contact" or "friction". */
const char *evaluate_kind(size_t constraint);

/* Logs that a constraint cannot be fulfilled with the others. */
void log_violated(const struct Instance *instance, enum Status status, double time, size_t constraint);

/* Updates the values that depend only on parameters. Discards, after logging, if a constant matrix is singular. */
enum Status evaluate_prepare(struct Instance *instance);

/*
 * Returns the point at which accelerations and forces are evaluated, with current parameter constants: that of the
 * instance's time and state. The integrator of an importer leaves the constraints by its error. There redundant
 * constraints contradict each other: beyond the angle of saddle_pivot() they count as independent, with large forces.
 * If there are any, the state is the nearest one that fulfils the constraints.
 */
struct Point evaluate_point(struct Instance *instance);

/*
 * Computes derivative[state_count] at a point with current parameter constants. False if it is not finite or the mass
 * matrix is singular; instance->singular names the coordinate.
 */
bool evaluate_derivatives(struct Instance *instance, const struct Point *point, double *derivative);

/*
 * Does the same at a point that a method or an importer tries, and that may lie beyond the end of a piece. Where the
 * piece has no value, as sqrt(max(0, h)) for h < 0, the derivative is by the piece there.
 */
bool evaluate_derivatives_beyond(struct Instance *instance, const struct Point *point, double *derivative);

/*
 * Computes the derivative at the instance's state, and updates parameter constants. Discards, after logging why, if
 * there is no derivative.
 */
enum Status evaluate_fmu_state(struct Instance *instance, double *derivative);

/* Returns the name of a state whose rate is not finite at the instance's state; NULL if there is none. */
const char *evaluate_rate_without_value(struct Instance *instance);

/* Logs why evaluate_derivatives() returned false, with this status. */
void log_singularity(struct Instance *instance, enum Status status, double time);

/* Logs why a requested value or derivative does not exist, once for each snapshot. Returns STATUS_DISCARD. */
enum Status discard_for_singularity(struct Instance *instance);

/*
 * Returns the accelerations and constraint forces for result() at a point, from the derivative of the state there. NULL
 * if the mass matrix is singular; instance->singular names the coordinate.
 */
const double *evaluate_accelerations(struct Instance *instance, const struct Point *point, const double *derivative);

/* Returns their derivatives along a seed, from the derivative of the state along it. */
const double *evaluate_accelerations_along(struct Instance *instance, const struct Point *point,
                                           const struct Seed *seed, const double *derivative_along);

/* Computes the value of a Real variable. Discards after logging if it is not finite. */
enum Status evaluate_variable(struct Instance *instance, const struct ScalarVariable *variable, double *value);

/*
 * Returns the derivative of an output, a state or a state derivative along a seed. derivative_along: state_count values
 * from directional(). The accelerations come from the functions above.
 */
double evaluate_along(const struct ScalarVariable *variable, const struct Point *point, const struct Seed *seed,
                      const double *derivative_along, const double *acceleration, const double *acceleration_along);
