/* Evaluation of the generated functions at the instance's situation. */
#ifndef EVALUATE_H
#define EVALUATE_H

#include <math.h>

#include "instance/instance.h"

/* Whether all of value[count] are finite: infinities and NaN leave a NaN in the sum. */
static inline bool are_finite(const double *value, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += value[i] - value[i];
  return sum == 0.0;
}

/* The size of a state, for comparisons: at least its nominal value. */
static inline double scale_of(const double *state, size_t i) {
  return fmax(fabs(state[i]), lagrangian.steps.nominal[i]);
}

/* The largest among the coordinates, or the velocities, where first is the first of them. */
static inline double largest_scale(const double *state, size_t first) {
  double scale = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) scale = fmax(scale, scale_of(state, first + i));
  return scale;
}

/* The name of the variable of a kind with this index; "" for none. */
const char *evaluate_name(enum VariableKind kind, size_t index);

/* The element that a constraint is of, in messages: "constraint", "contact" or "friction". */
const char *evaluate_kind(size_t constraint);

/* Says that a constraint cannot be kept with the others. */
void log_unkept(const struct Instance *instance, enum Status status, double time, size_t constraint);

/* What prepare() makes of the parameters, brought up to date. Discards after logging a singular matrix. */
enum Status evaluate_prepare(struct Instance *instance);

/*
 * derivative[state_count] at a point whose prepared values are up to date. False where it is not finite or the mass
 * matrix is singular, which instance->singular then tells.
 */
bool evaluate_derivatives(struct Instance *instance, const struct Point *point, double *derivative);

/* The same at the situation, prepared values included. Discards after logging why there is no derivative. */
enum Status evaluate_situation(struct Instance *instance, double *derivative);

/* Logs why evaluate_derivatives() returned false, as a message of this status. */
void log_singularity(const struct Instance *instance, enum Status status, double time);

/* The same where a value or derivative is asked for at the situation: logs once for each situation. Discards. */
enum Status discard_for_singularity(struct Instance *instance);

/*
 * What result() takes at a point, from the derivative of the state there: the accelerations and the forces of
 * constraints. NULL where the mass matrix is singular, which instance->singular then tells.
 */
const double *evaluate_accelerations(struct Instance *instance, const struct Point *point, const double *derivative);

/* The same along a direction, from the derivative of the state along it. */
const double *evaluate_accelerations_along(struct Instance *instance, const struct Point *point,
                                           const struct Seed *seed, const double *derivative_along);

/* The value of a Real variable. Discards after logging where it is not finite. */
enum Status evaluate_variable(struct Instance *instance, const struct ScalarVariable *variable, double *value);

/*
 * The derivative of an output, a state or a state derivative along seed; derivative_along holds state_count values from
 * directional(), the accelerations are those of the functions above.
 */
double evaluate_along(const struct ScalarVariable *variable, const struct Point *point, const struct Seed *seed,
                      const double *derivative_along, const double *acceleration, const double *acceleration_along);

#endif
