/*
 * Projection onto the constraints c(q) = 0 (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section
 * VII.2). The nearest point q + d in the metric of the mass matrix M minimizes d^T M d / 2. Newton's method, without
 * second derivatives of c, has the matrix of the equations of motion; d is the sum of the moves so far:
 *
 *   M dq + J^T mu = -M d,   J dq = -c(q + d)
 *
 * The velocities follow at the new coordinates. Their constraints are linear, so one step M dv + J^T mu = 0, J dv =
 * -residual suffices.
 *
 * Redundant constraints get infinite pivots (saddle.h) and are left out of the step. others_hold() checks that they
 * agree with the others. An iteration costs one evaluation and factorization. It ends when the change is below
 * converged, or below rounded_away without shrinking further; otherwise after STEP_LIMIT iterations, as a failure.
 */
#include "instance/projection.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"
#include "support/arena.h"

/* Iterations from a state near the constraints, and from start values. */
enum { STEP_LIMIT = 10, START_LIMIT = 100 };

static const double converged = 1e-9;    /* change in units of the scales: its square is below rounding */
static const double rounded_away = 1e-6; /* change that is rounding error if it stops shrinking: terms may cancel */
static const double largest_move = 0.5;  /* of start values in one iteration, in units of their scales */
static const double fulfilled = 1e-10;   /* largest residual as a length, in units of the scale of the state */
static const double redundant_residual = 1e-8; /* the same for a redundant constraint, before the last change */
/* The same for the velocity of a friction that sticks, which may creep where others nearly hold it; times the tolerance. */
static const double creep_share = 0.1;
static const double largest_jump = 0.1; /* residual by an input's change, in units of the scale of the state */
static const double noted_move = 1e-2;  /* with prescribed inputs: moves to log, in the same units */
static const double vanishing = 1e-6;   /* ratio of a row of J where its constraint holds to the row nearby */

/*
 * The workspace, before its arrays. change, residual, pivot and slope follow each other, as lagrangian.constraints
 * has them.
 */
struct ProjectionWork {
  double *change;                   /* of the coordinates or velocities */
  double *residual, *pivot, *slope; /* of each constraint: -residual, pivot, length of its row of J */
  double *moved;                    /* state_count: the sum of the moves of the coordinates */
  double *before;                   /* state_count */
  double *start;                    /* state_count: where project() began */
  double *first_slope;              /* of each constraint */
  double *rounding;                 /* rounding error bounds of the indicators */
  size_t first; /* the first state that the residuals belong to: 0 for coordinates, coordinate_count for velocities */
};

static size_t lay_out_projection(void *block) {
  struct ProjectionWork counted, *work = block != NULL ? block : &counted;
  struct Arena arena = {(uintptr_t)block + sizeof *work};
  ARENA_NUMBERS(&arena, lagrangian.coordinate_count, &work->change);
  ARENA_NUMBERS(&arena, lagrangian.constraints.count, &work->residual, &work->pivot, &work->slope, &work->first_slope);
  ARENA_NUMBERS(&arena, lagrangian.state_count, &work->moved, &work->before, &work->start);
  ARENA_NUMBERS(&arena, indicator_count(lagrangian.switches), &work->rounding);
  return arena.next - (uintptr_t)block;
}

/* Returns the largest of coordinate_count values, in units of the scales of the states from first on. */
static double size_of(const double *value, const double *state, size_t first) {
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    double size = fabs(value[i]) / scale_of(state, first + i);
    if (!(size <= largest)) largest = size;
  }
  return largest;
}

/* The projected quantity: coordinates or velocities, those of a step or of the start. */
enum ProjectionTarget { POSITIONS, VELOCITIES, START_POSITIONS, START_VELOCITIES };

/* Evaluates change, residuals, pivots and slopes. False if M is singular or a value is not finite. */
static bool evaluate_residual(struct Instance *instance, double time, const double *state,
                              enum ProjectionTarget target) {
  struct ProjectionWork *work = instance->projection_work;
  struct Point point = solver_point(instance, time, state);
  struct Seed seed = {.state = work->moved};
  bool is_of_positions = target == POSITIONS || target == START_POSITIONS;
  work->first = is_of_positions ? 0 : lagrangian.coordinate_count;
  switch (target) {
  case POSITIONS: instance->singular = lagrangian.constraints.correct_positions(&point, &seed, work->change); break;
  case VELOCITIES: instance->singular = lagrangian.constraints.correct_velocities(&point, work->change); break;
  case START_POSITIONS: instance->singular = lagrangian.constraints.start_positions(&point, &seed, work->change); break;
  case START_VELOCITIES: instance->singular = lagrangian.constraints.start_velocities(&point, work->change); break;
  }
  return instance->singular == 0 && are_finite(work->change, lagrangian.coordinate_count) &&
         are_finite(work->residual, lagrangian.constraints.count);
}

/*
 * True if all residuals of the coordinates are rounding errors. A closed contact's gap may have terms much larger than
 * the coordinates. A move by their rounding error is no motion, and would shorten the steps of methods of variable
 * order. Sets such residuals to 0.
 */
static bool residual_is_rounding(struct Instance *instance, double time, const double *state) {
  const struct SwitchTable *switches = lagrangian.switches;
  const struct ProjectionWork *work = instance->projection_work;
  if (switches == NULL || switches->contact_count == 0) return false;
  struct Point point = solver_point(instance, time, state);
  switches->rounding_bounds(&point, instance->acceleration, work->rounding);
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t constraint = switches->contacts[i].constraint;
    double rounding = DBL_EPSILON * work->rounding[contact_indicator(switches, i)];
    if (fabs(work->residual[constraint]) <= rounding) work->residual[constraint] = 0.0;
  }
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (work->residual[j] != 0.0) return false;
  return true;
}

static void move_positions(const struct ProjectionWork *work, double *state, double share) {
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    state[i] += share * work->change[i];
    work->moved[i] += share * work->change[i];
  }
}

static double move_velocities(struct Instance *instance, double time, double *state, enum ProjectionTarget target) {
  size_t n = lagrangian.coordinate_count;
  if (!evaluate_residual(instance, time, state, target)) return INFINITY;
  const struct ProjectionWork *work = instance->projection_work;
  double size = size_of(work->change, state, n);
  for (size_t i = 0; i < n; i++) state[n + i] += work->change[i];
  return size;
}

/* Returns the residual of a redundant constraint that is allowed. */
static double allowed_residual(const struct Instance *instance, size_t constraint) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_of_friction = false;
  for (size_t i = 0; switches != NULL && i < switches->friction_count; i++)
    is_of_friction |= switches->frictions[i].constraint == constraint;
  return is_of_friction ? fmax(redundant_residual, creep_share * solver_tolerance(instance)) : redundant_residual;
}

/* True if redundant constraints agree with the others: a constraint may be redundant only at the start. */
static bool others_hold(const struct Instance *instance, const double *state, size_t first) {
  const struct ProjectionWork *work = instance->projection_work;
  double scale = largest_scale(state, first);
  bool hold = true;
  for (size_t j = 0; j < lagrangian.constraints.count && hold; j++)
    hold = !isinf(work->pivot[j]) || fabs(work->residual[j]) <= allowed_residual(instance, j) * work->slope[j] * scale;
  return hold;
}

/* True if a constraint follows from others. The row of an open contact is 0, and takes no part. */
static bool is_redundant(const struct ProjectionWork *work, size_t constraint) {
  return isinf(work->pivot[constraint]) && work->slope[constraint] > 0.0;
}

static bool has_redundant(const struct ProjectionWork *work) {
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (is_redundant(work, j)) return true;
  return false;
}

/*
 * Projects the velocities at consistent coordinates. Returns the largest change in units of the scales. Sets the
 * residuals to 0 on success.
 */
static double project_velocities(struct Instance *instance, double time, double *state) {
  const struct ProjectionWork *work = instance->projection_work;
  double size = move_velocities(instance, time, state, VELOCITIES);
  bool hold = isfinite(size) && (!has_redundant(work) || (evaluate_residual(instance, time, state, VELOCITIES) &&
                                                          others_hold(instance, state, lagrangian.coordinate_count)));
  if (!hold) return INFINITY;
  memset(work->residual, 0, lagrangian.constraints.count * sizeof *work->residual);
  return size;
}

/* True if all constraints are those of frictions, which do not restrict coordinates, and of open contacts. */
static bool holds_velocities_alone(const struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches == NULL || lagrangian.constraints.count != switches->friction_count + switches->contact_count)
    return false;
  bool any_closed = false;
  for (size_t i = 0; i < switches->contact_count; i++) any_closed |= contact_holds(instance, i);
  return !any_closed;
}

static double project(struct Instance *instance, double time, double *state) {
  const struct ProjectionWork *work = instance->projection_work;
  double size = INFINITY, before;
  memcpy(work->start, state, lagrangian.state_count * sizeof *state);
  if (holds_velocities_alone(instance)) return project_velocities(instance, time, state);
  memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
  for (int iteration = 0; iteration < STEP_LIMIT; iteration++) {
    if (!evaluate_residual(instance, time, state, POSITIONS)) return INFINITY;
    before = size;
    size = size_of(work->change, state, 0);
    bool is_rounded = size > 0.0 && size <= rounded_away && residual_is_rounding(instance, time, state);
    bool is_done = is_rounded || size <= converged || (size <= rounded_away && size >= before);
    if (is_done && !others_hold(instance, state, 0)) return INFINITY;
    if (!is_rounded) move_positions(work, state, 1.0);
    if (!is_done) continue;
    double velocities = project_velocities(instance, time, state);
    return fmax(size_of(work->moved, state, 0), velocities);
  }
  return INFINITY;
}

static bool found_redundant(struct Instance *instance) {
  return has_redundant(instance->projection_work);
}

static double drift(struct Instance *instance, double time) {
  const struct ProjectionWork *work = instance->projection_work;
  memcpy(work->before, instance->state, lagrangian.state_count * sizeof *work->before);
  return project(instance, time, work->before);
}

/* A state off by less than converged stays: where constraints are nearly redundant, a move would magnify rounding. */
static const double *nearest(struct Instance *instance, double time) {
  double size = drift(instance, time);
  return isfinite(size) && size > converged ? instance->projection_work->before : NULL;
}

/* Returns the first constraint whose residual is not finite. */
static size_t find_without_value(const struct ProjectionWork *work) {
  size_t j = 0;
  while (j + 1 < lagrangian.constraints.count && isfinite(work->residual[j])) j++;
  return j;
}

/* Returns the residual of a constraint as a length in units of scale. */
static double residual_length(const struct ProjectionWork *work, size_t constraint, double scale) {
  double residual = work->residual[constraint];
  return residual == 0.0 ? 0.0 : fabs(residual) / (work->slope[constraint] * scale);
}

/* Returns the constraint of largest residual above *most, and sets *most to it; constraints.count for none. */
static size_t find_largest_residual(const struct ProjectionWork *work, const double *state, size_t first,
                                    double *most) {
  size_t worst = lagrangian.constraints.count;
  double scale = largest_scale(state, first);
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    double way = residual_length(work, j, scale);
    if (way > *most) {
      *most = way;
      worst = j;
    }
  }
  return worst;
}

/* Returns the constraint of largest residual; constraints.count if all are at most fulfilled. */
static size_t find_violated(const struct ProjectionWork *work, const double *state, size_t first) {
  double most = fulfilled;
  return find_largest_residual(work, state, first, &most);
}

/*
 * Returns the constraint of largest residual that project() has left; if all are fulfilled, that at its start, among
 * coordinates and velocities.
 */
static size_t violated_constraint(struct Instance *instance, double time) {
  const struct ProjectionWork *work = instance->projection_work;
  int singular = instance->singular;
  size_t n = lagrangian.coordinate_count, none = lagrangian.constraints.count, larger = none;
  size_t found = find_violated(work, work->start, work->first);
  if (found == none) {
    double most = fulfilled;
    memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
    if (evaluate_residual(instance, time, work->start, POSITIONS))
      found = find_largest_residual(work, work->start, 0, &most);
    if (evaluate_residual(instance, time, work->start, VELOCITIES))
      larger = find_largest_residual(work, work->start, n, &most);
    if (larger < none) found = larger;
  }
  instance->singular = singular;
  return found < none ? found : 0;
}

/*
 * Moves the coordinates from afar onto the constraints: to the nearest point if least, else to any point. False if the
 * iterations do not converge.
 */
static bool approach_from(struct Instance *instance, double time, double *state, enum ProjectionTarget target,
                          bool least) {
  const struct ProjectionWork *work = instance->projection_work;
  memcpy(state, work->before, lagrangian.state_count * sizeof *state);
  memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
  for (int iteration = 0; iteration < START_LIMIT; iteration++) {
    if (!least) memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
    if (evaluate_prepare(instance) != STATUS_DONE) return false; /* before the start, modes follow the state */
    if (!evaluate_residual(instance, time, state, target)) return false;
    double size = size_of(work->change, state, 0);
    move_positions(work, state, least && size > largest_move ? largest_move / size : 1.0);
    if (size <= converged) return true;
  }
  return false;
}

/* Moves the coordinates. Returns the constraint that cannot be fulfilled; constraints.count for none. */
static size_t approach_positions(struct Instance *instance, double time, double *state, enum ProjectionTarget target) {
  const struct ProjectionWork *work = instance->projection_work;
  if (!approach_from(instance, time, state, target, true)) approach_from(instance, time, state, target, false);
  memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
  bool has_value = evaluate_prepare(instance) == STATUS_DONE && evaluate_residual(instance, time, state, target);
  if (!has_value) return find_without_value(work);
  residual_is_rounding(instance, time, state);
  return find_violated(work, state, 0);
}

static size_t approach_velocities(struct Instance *instance, double time, double *state, enum ProjectionTarget target) {
  const struct ProjectionWork *work = instance->projection_work;
  if (!isfinite(move_velocities(instance, time, state, target))) return 0;
  if (!evaluate_residual(instance, time, state, target)) return 0;
  return find_violated(work, state, lagrangian.coordinate_count);
}

/* Logs the coordinates and velocities that moved by more than a share of their scales. */
static void log_moves(const struct Instance *instance, const double *before, double share) {
  char text[600] = "";
  int length = 0;
  for (size_t i = 0; i < 2 * lagrangian.coordinate_count && length < 500; i++) {
    double after = instance->state[i];
    if (fabs(after - before[i]) <= share * scale_of(before, i)) continue;
    length += snprintf(text + length, sizeof text - (size_t)length, "%s%.60s from %.9g to %.9g", length > 0 ? ", " : "",
                       evaluate_name(VARIABLE_STATE, i), before[i], after);
  }
  if (length > 0)
    log_message(instance, STATUS_DONE, "time %g: moved to fulfil the constraints: %s%s", instance->fmu_state->time,
                text, length >= 500 ? ", ..." : "");
}

static void log_redundant(const struct Instance *instance, const struct ProjectionWork *work) {
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (is_redundant(work, j))
      log_message(instance, STATUS_DONE, "time %g: the %s '%s' is redundant; the forces are those of least norm",
                  instance->fmu_state->time, evaluate_kind(j), lagrangian.constraints.names[j]);
}

static bool report_violated(struct Instance *instance, size_t constraint, const char *what) {
  const struct ProjectionWork *work = instance->projection_work;
  if (instance->singular != 0) {
    log_singularity(instance, STATUS_ERROR, instance->fmu_state->time);
    return false;
  }
  const char *name = lagrangian.constraints.names[constraint], *kind = evaluate_kind(constraint);
  if (!isfinite(work->residual[constraint]))
    reject_call(instance, "the %s '%s' has no finite value at these start values; expected others", kind, name);
  else
    reject_call(instance,
                "no %s near the start values fulfil the %s '%s' with the others: its residual is %g; expected start "
                "values nearer to a solution, fewer of them fixed, or other parameters",
                what, kind, name, -work->residual[constraint]);
  return false;
}

/*
 * Returns the first constraint whose derivatives vanish where it holds, as those of (x^2 + y^2 - l^2)^2 = 0;
 * constraints.count for none. Such a constraint exerts no force. Compares the rows of J with those at a state nearby.
 * state: the instance's own, which piecewise functions follow; it is restored.
 */
static size_t find_vanishing(struct Instance *instance, double time, double *state) {
  const struct ProjectionWork *work = instance->projection_work;
  size_t n = lagrangian.coordinate_count, found = 0;
  double *there = work->moved; /* workspace that projections of velocities do not use */
  if (!evaluate_residual(instance, time, state, VELOCITIES)) return lagrangian.constraints.count;
  memcpy(work->first_slope, work->slope, lagrangian.constraints.count * sizeof *work->slope);
  memcpy(there, state, lagrangian.state_count * sizeof *state);
  for (size_t i = 0; i < n; i++) state[i] += (i % 2 == 0 ? 1e-3 : -7e-4) * scale_of(state, i);
  bool has_value = evaluate_prepare(instance) == STATUS_DONE && evaluate_residual(instance, time, state, VELOCITIES);
  memcpy(state, there, lagrangian.state_count * sizeof *state);
  if (evaluate_prepare(instance) != STATUS_DONE || !has_value) return lagrangian.constraints.count;
  while (found < lagrangian.constraints.count &&
         (work->slope[found] == 0.0 || !(work->first_slope[found] <= vanishing * work->slope[found])))
    found++; /* the derivative of an open contact is 0 everywhere */
  return found;
}

static bool report_vanishing(struct Instance *instance, size_t constraint) {
  reject_call(instance,
              "the derivatives of the %s '%s' vanish where it holds, so that it exerts no force; expected it without a "
              "square, a root or abs of the whole, or a start away from a singular position",
              evaluate_kind(constraint), lagrangian.constraints.names[constraint]);
  return false;
}

/* Restores fixed start values after changes by rounding. False, with an error, if one had to move further. */
static bool keep_fixed(struct Instance *instance, const double *before) {
  size_t n = lagrangian.coordinate_count;
  for (size_t i = 0; i < 2 * n; i++) {
    if (!lagrangian.constraints.coordinate_is_fixed[i % n]) continue;
    if (fabs(instance->state[i] - before[i]) > 1e-9 * scale_of(before, i)) {
      reject_call(instance,
                  "the constraints hold only where '%s' is %.9g, but its start is fixed at %.9g; expected this start "
                  "value, or fewer fixed coordinates",
                  evaluate_name(VARIABLE_STATE, i), instance->state[i], before[i]);
      return false;
    }
    instance->state[i] = before[i];
  }
  return true;
}

static bool make_consistent(struct Instance *instance) {
  const struct ProjectionWork *work = instance->projection_work;
  double time = instance->fmu_state->time;
  bool keeps_fixed = lagrangian.constraints.coordinate_is_fixed != NULL;
  memcpy(work->before, instance->state, lagrangian.state_count * sizeof *work->before);
  size_t violated = approach_positions(instance, time, instance->state, keeps_fixed ? START_POSITIONS : POSITIONS);
  size_t vanishing_one = find_vanishing(instance, time, instance->state);
  if (vanishing_one < lagrangian.constraints.count) return report_vanishing(instance, vanishing_one);
  if (violated < lagrangian.constraints.count) {
    memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
    evaluate_residual(instance, time, instance->state, POSITIONS);
    return report_violated(instance, violated, "coordinates");
  }
  violated = approach_velocities(instance, time, instance->state, keeps_fixed ? START_VELOCITIES : VELOCITIES);
  if (violated < lagrangian.constraints.count) return report_violated(instance, violated, "velocities");
  log_redundant(instance, work);
  if (keeps_fixed && !keep_fixed(instance, work->before)) return false;
  log_moves(instance, work->before, instance->fmu_state->tolerance);
  return true;
}

/* True if an input has jumped: coordinates cannot follow it. Logs that the step is discarded. */
static bool has_jumped(struct Instance *instance) {
  const struct ProjectionWork *work = instance->projection_work;
  double time = instance->fmu_state->time, scale = largest_scale(instance->state, 0);
  memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
  if (lagrangian.constraints.prescribed_input_count == 0 ||
      !evaluate_residual(instance, time, instance->state, POSITIONS))
    return false;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    if (lagrangian.constraints.inputs[j] == NULL || residual_length(work, j, scale) <= largest_jump) continue;
    log_message(instance, STATUS_DISCARD,
                "time %g: the residual of the %s '%s' is %g after a jump of an input: it depends on %s; expected "
                "inputs that move continuously, as their derivatives say",
                time, evaluate_kind(j), lagrangian.constraints.names[j], -work->residual[j],
                lagrangian.constraints.inputs[j]);
    return true;
  }
  return false;
}

static void log_contradiction(struct Instance *instance, size_t constraint, const char *what) {
  double time = instance->fmu_state->time;
  if (instance->singular != 0) log_singularity(instance, STATUS_DISCARD, time);
  else
    log_message(instance, STATUS_DISCARD,
                "time %g: after a parameter or an input was set, no %s near the present ones fulfil the %s '%s' with "
                "the others: its residual is %g; expected values with a solution nearby",
                time, what, evaluate_kind(constraint), lagrangian.constraints.names[constraint],
                -instance->projection_work->residual[constraint]);
}

static bool follow_change(struct Instance *instance) {
  const struct ProjectionWork *work = instance->projection_work;
  double time = instance->fmu_state->time;
  const char *what = "coordinates";
  if (has_jumped(instance)) return false;
  memcpy(work->before, instance->state, lagrangian.state_count * sizeof *work->before);
  size_t violated = approach_positions(instance, time, instance->state, POSITIONS);
  if (violated == lagrangian.constraints.count) {
    what = "velocities";
    violated = approach_velocities(instance, time, instance->state, VELOCITIES);
  }
  if (violated == lagrangian.constraints.count) {
    log_moves(instance, work->before,
              lagrangian.constraints.prescribed_input_count > 0 ? noted_move : instance->fmu_state->tolerance);
    return true;
  }
  log_contradiction(instance, violated, what);
  memcpy(instance->state, work->before, lagrangian.state_count * sizeof *work->before);
  return false;
}

static const char *weakest(struct Instance *instance, double time, const double *state) {
  const struct ProjectionWork *work = instance->projection_work;
  size_t found = 0;
  double least = INFINITY;
  memset(work->moved, 0, lagrangian.state_count * sizeof *work->moved);
  if (!evaluate_residual(instance, time, state, POSITIONS)) return NULL;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    double hold = fabs(work->pivot[j]) / (work->slope[j] * work->slope[j]);
    if (!(hold < least)) continue;
    least = hold;
    found = j;
  }
  return lagrangian.constraints.names[found];
}

const struct Projection projection = {.lay_out = lay_out_projection,
                                      .project = project,
                                      .drift = drift,
                                      .nearest = nearest,
                                      .found_redundant = found_redundant,
                                      .make_consistent = make_consistent,
                                      .follow_change = follow_change,
                                      .violated_constraint = violated_constraint,
                                      .weakest = weakest};
