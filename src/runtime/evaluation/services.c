#include "evaluation/services.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/inputs.h"
#include "instance/active_constraints.h"
#include "instance/projection.h"

const char solver_vanished_step[] = "the step size fell below the resolution of time, as at a singularity";

void solver_move_point(struct Instance *instance, struct Point *point, double time, const double *state) {
  point->time = time;
  point->state = state;
  if (instance->fmu_state->input_derivatives_set) {
    evaluate_inputs(instance, time, instance->work);
    point->input = instance->work;
  }
}

struct Point solver_point(struct Instance *instance, double time, const double *state) {
  struct Point point = instance_point(instance);
  solver_move_point(instance, &point, time, state);
  return point;
}

bool solver_interpolate(const struct Solver *solver, struct Instance *instance, const double *times, size_t count,
                        double *states) {
  if (solver->interpolate_at != NULL) return solver->interpolate_at(instance, times, count, states);
  bool are_known = true;
  for (size_t i = 0; i < count && are_known; i++)
    are_known = solver->interpolate(instance, times[i], states + i * lagrangian.state_count);
  return are_known;
}

bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative) {
  struct Point point = solver_point(instance, time, state);
  instance->fmu_state->statistics[STATISTIC_DERIVATIVES]++;
  return evaluate_derivatives(instance, &point, derivative);
}

bool solver_derivatives_beyond(struct Instance *instance, double time, const double *state, double *derivative) {
  struct Point point = solver_point(instance, time, state);
  instance->fmu_state->statistics[STATISTIC_DERIVATIVES]++;
  return evaluate_derivatives_beyond(instance, &point, derivative);
}

/* Computes the Jacobian by columns from directional derivatives. Its workspace follows the inputs in instance->work. */
static int jacobian_by_directions(struct Instance *instance, const struct Point *point, double *values) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  const size_t states = lagrangian.state_count;
  double *direction = instance->work + lagrangian.input_count, *column = direction + states, *zeros = column + states;
  struct Seed seed = {.state = direction, .input = zeros, .parameter = zeros + lagrangian.input_count};
  int singular = 0;
  memset(direction, 0, states * sizeof *direction);
  memset(zeros, 0, (lagrangian.input_count + lagrangian.parameter_count) * sizeof *zeros);
  for (size_t j = 0; j < states && singular == 0; j++) {
    direction[j] = 1.0;
    seed.repeats = j > 0;
    singular = lagrangian.directional(point, &seed, column);
    direction[j] = 0.0;
    for (int k = pattern->start[j]; k < pattern->start[j + 1]; k++) values[k] = column[pattern->row[k]];
  }
  return singular;
}

bool solver_jacobian(struct Instance *instance, double time, const double *state, double *values) {
  struct Point point = solver_point(instance, time, state);
  instance->fmu_state->statistics[STATISTIC_JACOBIANS]++;
  instance->singular = lagrangian.implicit.jacobian != NULL ? lagrangian.implicit.jacobian(&point, values)
                                                            : jacobian_by_directions(instance, &point, values);
  return instance->singular == 0;
}

bool solver_take_state(struct Instance *instance, double time) {
  const struct Span *last = &instance->fmu_state->last_step;
  bool is_at_event = lagrangian.event_laws != NULL && last->start == last->end && last->end == time;
  if (is_at_event) memcpy(instance->state, instance->event_state, lagrangian.state_count * sizeof(double));
  else if (!lagrangian.solver->interpolate(instance, time, instance->state)) return false;
  return are_finite(instance->state, lagrangian.state_count);
}

bool solver_has_constraints(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (lagrangian.constraints.projection == NULL) return false;
  bool has_others = switches == NULL || switches->plane_count > 0 ||
                    lagrangian.constraints.count > switches->contact_count + switches->friction_count;
  if (has_others) return true;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (contact_holds(instance, i)) return true;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (friction_holds(instance, i)) return true;
  return false;
}

/* A step errs by about the tolerance. If the projection moves the state by 1000 times that, the step is wrong. */
const char *solver_project(struct Instance *instance, double time, double *state) {
  static const char problem[] = "a constraint cannot be fulfilled";
  if (!solver_has_constraints(instance)) return NULL;
  double moved = lagrangian.constraints.projection->project(instance, time, state);
  bool is_kept = moved <= 1000.0 * fmax(instance->fmu_state->tolerance, 1e-10);
  instance->violated_constraint =
      is_kept ? 0 : 1 + lagrangian.constraints.projection->violated_constraint(instance, time);
  return is_kept ? NULL : problem;
}

void solver_free_memory(struct Instance *instance) {
  instance->memory.free(instance->solver_memory);
  instance->solver_memory = NULL;
}

bool solver_is_out_of_memory(struct Instance *instance) {
  instance->is_out_of_memory = true;
  log_message(instance, STATUS_ERROR, "out of memory for the solver");
  return false;
}

bool solver_step_vanishes(double time, double step) {
  return step <= 8 * DBL_EPSILON * fabs(time);
}

double solver_tolerance(const struct Instance *instance) {
  double smallest = INFINITY;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) smallest = fmin(smallest, lagrangian.steps.nominal[i]);
  return instance->fmu_state->tolerance * smallest;
}

double solver_error(const struct Instance *instance) {
  const struct Solver *solver = lagrangian.solver;
  if (solver->at_work != NULL) solver = solver->at_work(instance);
  return solver->finer == NULL ? 0.0 : solver_tolerance(instance);
}
