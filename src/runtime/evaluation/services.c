#include "evaluation/services.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/inputs.h"
#include "instance/projection.h"

const char solver_resting[] = "the steps become too short to change the time, as at a singularity";

struct Point solver_point(struct Instance *instance, double time, const double *state) {
  struct Point point = instance_point(instance);
  point.time = time;
  point.state = state;
  if (instance->situation->input_derivatives_set) {
    evaluate_inputs(instance, time, instance->work);
    point.input = instance->work;
  }
  return point;
}

bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative) {
  struct Point point = solver_point(instance, time, state);
  instance->situation->statistics[STATISTIC_DERIVATIVES]++;
  return evaluate_derivatives(instance, &point, derivative);
}

bool solver_jacobian(struct Instance *instance, double time, const double *state, double *values) {
  struct Point point = solver_point(instance, time, state);
  instance->situation->statistics[STATISTIC_JACOBIANS]++;
  instance->singular = lagrangian.implicit.jacobian(&point, values);
  return instance->singular == 0;
}

bool solver_take_state(struct Instance *instance, double time) {
  const struct Span *last = &instance->situation->last_step;
  bool is_at_event = lagrangian.event_laws != NULL && last->start == last->end && last->end == time;
  if (is_at_event) memcpy(instance->state, instance->event_state, lagrangian.state_count * sizeof(double));
  else if (!lagrangian.solver->interpolate(instance, time, instance->state)) return false;
  return are_finite(instance->state, lagrangian.state_count);
}

/* Errors of a step are of the size of the tolerance; where more is lacking, the step has left the mechanism. */
const char *solver_project(struct Instance *instance, double time, double *state) {
  static const char problem[] = "a constraint cannot be kept there";
  if (lagrangian.constraints.projection == NULL) return NULL;
  double moved = lagrangian.constraints.projection->project(instance, time, state);
  return moved <= 1000.0 * fmax(instance->situation->tolerance, 1e-10) ? NULL : problem;
}

void solver_free_memory(struct Instance *instance) {
  instance->memory.free(instance->solver_memory);
  instance->solver_memory = NULL;
}

bool solver_lacks_memory(const struct Instance *instance) {
  log_message(instance, STATUS_ERROR, "there is no memory for the solver");
  return false;
}

bool solver_rests(double time, double step) {
  return step <= 8 * DBL_EPSILON * fabs(time);
}

double solver_error(const struct Instance *instance) {
  if (lagrangian.solver->finer == NULL) return 0.0;
  double smallest = INFINITY;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) smallest = fmin(smallest, lagrangian.steps.nominal[i]);
  return instance->situation->tolerance * smallest;
}
