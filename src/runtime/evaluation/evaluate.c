#include "evaluation/evaluate.h"

#include <math.h>
#include <string.h>

#include "instance/initial_state.h"
#include "instance/event_laws.h"
#include "instance/projection.h"

const char *evaluate_name(enum VariableKind kind, size_t index) {
  for (size_t i = 0; i < lagrangian.variable_count; i++)
    if (lagrangian.variables[i].kind == kind && lagrangian.variables[i].index == index)
      return lagrangian.variables[i].name;
  return "";
}

const char *evaluate_kind(size_t constraint) {
  const struct SwitchTable *switches = lagrangian.switches;
  for (size_t i = 0; switches != NULL && i < switches->contact_count; i++)
    if (switches->contacts[i].constraint == constraint) return "contact";
  for (size_t i = 0; switches != NULL && i < switches->friction_count; i++)
    if (switches->frictions[i].constraint == constraint) return "friction";
  return "constraint";
}

void log_violated(const struct Instance *instance, enum Status status, double time, size_t constraint) {
  log_message(instance, status,
              "time %g: the %s '%s' cannot be fulfilled with the others; expected constraints that are consistent and "
              "do not jump, or other start values or parameters",
              time, evaluate_kind(constraint), lagrangian.constraints.names[constraint]);
}

const char *evaluate_rate_without_value(struct Instance *instance) {
  struct Point point = instance_point(instance);
  const size_t first = 2 * lagrangian.coordinate_count;
  double *derivative = instance->work;
  if (lagrangian.derivatives == NULL || lagrangian.derivatives(&point, derivative) != 0) return NULL;
  if (!are_finite(derivative, first)) return NULL; /* rates of first-order states depend on these */
  for (size_t i = first; i < lagrangian.state_count; i++)
    if (!isfinite(derivative[i])) return evaluate_name(VARIABLE_STATE, i);
  return NULL;
}

static void log_not_finite(struct Instance *instance, enum Status status, double time) {
  const struct EventLaws *laws = lagrangian.event_laws;
  if (laws != NULL && laws->explain_ball(instance, status, time)) return;
  const char *state = evaluate_rate_without_value(instance);
  if (state != NULL)
    log_message(instance, status,
                "time %g: the rate of '%s' is not finite, as when something is divided by 0, a root or a logarithm "
                "has a negative argument, or an integral leaves the range that lagc has named; try other parameters, "
                "inputs or start values",
                time, state);
  else
    log_message(
        instance, status,
        "time %g: the accelerations are not finite, as when something is divided by 0, exp or cosh gets a large "
        "argument, or an integral leaves the range that lagc has named; try other parameters, inputs or start values",
        time);
}

void log_singularity(struct Instance *instance, enum Status status, double time) {
  if (instance->singular == 0) {
    log_not_finite(instance, status, time);
    return;
  }
  size_t coordinate = (size_t)instance->singular - 1;
  const char *name = evaluate_name(VARIABLE_STATE, coordinate);
  log_message(instance, status,
              "time %g: the mass matrix is singular or not positive definite in coordinate '%s' (%s = %g); it depends "
              "on %s: keep these away from values where the coordinate is not defined",
              time, name, name, instance->state[coordinate], lagrangian.inertia_depends_on[coordinate]);
}

enum Status discard_for_singularity(struct Instance *instance) {
  uint64_t fmu_state = instance_checksum(instance->fmu_state, fmu_state_size());
  if (fmu_state != instance->reported_singularity) log_singularity(instance, STATUS_DISCARD, instance->fmu_state->time);
  instance->reported_singularity = fmu_state;
  return STATUS_DISCARD;
}

enum Status evaluate_prepare(struct Instance *instance) {
  if (lagrangian.event_laws != NULL && is_before_start(instance) && !instance->modes_stay) {
    lagrangian.event_laws->guess(instance);
    instance->parameter_constants_are_stale = true;
  }
  if (!instance->parameter_constants_are_stale) return STATUS_DONE;
  instance->singular = lagrangian.prepare(instance->parameter, instance->parameter_constants);
  if (instance->singular != 0) return discard_for_singularity(instance);
  instance->parameter_constants_are_stale = false;
  return STATUS_DONE;
}

struct Point evaluate_point(struct Instance *instance) {
  struct Point point = instance_point(instance);
  if (instance->fmu_state->has_redundant == 0) return point;
  const double *state = lagrangian.constraints.projection->nearest(instance, point.time);
  if (state != NULL) point.state = state;
  return point;
}

bool evaluate_derivatives(struct Instance *instance, const struct Point *point, double *derivative) {
  instance->singular = lagrangian.derivatives(point, derivative);
  if (instance->singular != 0) return false;
  return are_finite(derivative, lagrangian.state_count);
}

/* Changes to the pieces at a point without a value. False if there are no others, or before the start. */
static bool change_pieces(struct Instance *instance, const struct Point *point) {
  return lagrangian.event_laws != NULL && !is_before_start(instance) &&
         lagrangian.event_laws->change_pieces(instance, point);
}

bool evaluate_derivatives_beyond(struct Instance *instance, const struct Point *point, double *derivative) {
  if (evaluate_derivatives(instance, point, derivative)) return true;
  if (!change_pieces(instance, point)) return false;
  bool exists = evaluate_derivatives(instance, point, derivative);
  lagrangian.event_laws->return_pieces(instance);
  return exists;
}

enum Status evaluate_fmu_state(struct Instance *instance, double *derivative) {
  enum Status status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  struct Point point = evaluate_point(instance);
  if (!evaluate_derivatives_beyond(instance, &point, derivative)) return discard_for_singularity(instance);
  size_t n = lagrangian.coordinate_count;
  /* The coordinates change by the importer's own velocities. */
  if (point.state != instance->state) memcpy(derivative, instance->state + n, n * sizeof *derivative);
  return STATUS_DONE;
}

const double *evaluate_accelerations(struct Instance *instance, const struct Point *point, const double *derivative) {
  if (lagrangian.constraints.accelerations == NULL) return derivative + lagrangian.coordinate_count;
  instance->singular = lagrangian.constraints.accelerations(point, instance->acceleration);
  return instance->singular == 0 ? instance->acceleration : NULL;
}

const double *evaluate_accelerations_along(struct Instance *instance, const struct Point *point,
                                           const struct Seed *seed, const double *derivative_along) {
  if (lagrangian.constraints.accelerations_along == NULL) return derivative_along + lagrangian.coordinate_count;
  double *along = instance->acceleration + lagrangian.coordinate_count + lagrangian.constraints.count;
  instance->singular = lagrangian.constraints.accelerations_along(point, seed, along);
  return instance->singular == 0 ? along : NULL;
}

/* Evaluates a result at a point with current parameter constants. False if accelerations that it needs do not exist. */
static bool evaluate_result_at(struct Instance *instance, const struct Point *point, size_t result, double *value) {
  const double *acceleration = NULL;
  if (lagrangian.results.uses_acceleration[result]) {
    if (!evaluate_derivatives(instance, point, instance->work)) return false;
    acceleration = evaluate_accelerations(instance, point, instance->work);
    if (acceleration == NULL) return false;
  }
  *value = lagrangian.results.result(point, acceleration, result);
  return true;
}

static enum Status evaluate_result(struct Instance *instance, const struct ScalarVariable *variable, double *value) {
  enum Status status = evaluate_prepare(instance);
  if (status != STATUS_DONE) return status;
  bool feels_forces = lagrangian.results.uses_acceleration[variable->index];
  struct Point point = feels_forces ? evaluate_point(instance) : instance_point(instance);
  bool has_value = evaluate_result_at(instance, &point, variable->index, value);
  if (!(has_value && isfinite(*value)) && change_pieces(instance, &point)) {
    has_value = evaluate_result_at(instance, &point, variable->index, value);
    lagrangian.event_laws->return_pieces(instance);
  }
  return has_value ? STATUS_DONE : discard_for_singularity(instance);
}

/* Derivatives of coordinates are the velocities, even if accelerations do not exist. */
static enum Status evaluate_state_derivative(struct Instance *instance, size_t state, double *value) {
  if (state < lagrangian.coordinate_count) {
    *value = instance->state[lagrangian.coordinate_count + state];
    return STATUS_DONE;
  }
  enum Status status = evaluate_fmu_state(instance, instance->work);
  if (status == STATUS_DONE) *value = instance->work[state];
  return status;
}

/* Evaluates all indicators, since they share their evaluation. */
static enum Status evaluate_indicator(struct Instance *instance, size_t index, double *value) {
  double *indicator = instance->switching_work;
  if (!lagrangian.event_laws->indicators(instance, indicator)) return discard_for_singularity(instance);
  *value = indicator[index];
  return STATUS_DONE;
}

enum Status evaluate_variable(struct Instance *instance, const struct ScalarVariable *variable, double *value) {
  double result = 0.0;
  enum Status status = STATUS_DONE;
  switch (variable->kind) {
  case VARIABLE_TIME: result = instance->fmu_state->time; break;
  case VARIABLE_STATE: result = instance->state[variable->index]; break;
  case VARIABLE_INPUT: result = instance->input[variable->index]; break;
  case VARIABLE_PARAMETER:
  case VARIABLE_MODE:
  case VARIABLE_CONTACT: result = instance->parameter[variable->index]; break;
  case VARIABLE_DERIVATIVE: status = evaluate_state_derivative(instance, variable->index, &result); break;
  case VARIABLE_RESULT: status = evaluate_result(instance, variable, &result); break;
  case VARIABLE_INDICATOR: status = evaluate_indicator(instance, variable->index, &result); break;
  case VARIABLE_STATISTIC: return STATUS_ERROR; /* not a Real */
  }
  if (status == STATUS_DONE && !isfinite(result)) {
    log_message(instance, STATUS_DISCARD, "time %g: '%s' has no finite value; try other parameters or states",
                instance->fmu_state->time, variable->name);
    status = STATUS_DISCARD;
  }
  if (status == STATUS_DONE) *value = result;
  return status;
}

double evaluate_along(const struct ScalarVariable *variable, const struct Point *point, const struct Seed *seed,
                      const double *derivative_along, const double *acceleration, const double *acceleration_along) {
  switch (variable->kind) {
  case VARIABLE_TIME: return seed->time;
  case VARIABLE_STATE: return seed->state[variable->index];
  case VARIABLE_DERIVATIVE: return derivative_along[variable->index];
  case VARIABLE_RESULT:
    return lagrangian.results.result_along(point, seed, acceleration, acceleration_along, variable->index);
  default: return NAN;
  }
}
