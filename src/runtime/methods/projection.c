/*
 * Projection onto the constraints by Newton's method with the matrix K of the equations of motion: from q,
 *
 *   M dq + J^T mu = -M (what q has been moved so far),   J dq = -constraint,
 *
 * whose limit is the point on the constraints that is nearest in the metric of M; then the velocities, in one step.
 */
#include "instance/projection.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"

enum { STEP_LIMIT = 10, START_LIMIT = 100 };

static const double converged = 1e-9;    /* a change whose square is below rounding */
static const double rounded_away = 1e-6; /* a change that gets no smaller: constraints whose terms cancel are rounded */
static const double largest_move = 0.5;  /* of start values in one iteration, in units of their scales */
static const double fulfilled = 1e-10;   /* what a constraint may lack, as a share of the scale of the state */
static const double redundant_lack = 1e-8; /* the same of one that follows from others, before the last change */
static const double largest_jump = 0.1;    /* of what an input moves, in units of the scale of the state */
static const double noted_move = 1e-2;     /* the same where it moves as it should, from step to step */
static const double vanishing = 1e-6;      /* the length of a row of J where a constraint holds, against that nearby */

/* The parts of the workspace. */
struct Work {
  double *change;               /* of the coordinates, or the velocities */
  double *lack, *pivot, *slope; /* of each constraint */
  double *moved;                /* state_count: the coordinates so far */
  double *before;               /* state_count */
  double *start;                /* state_count: from where project() moves a state */
  double *first_slope;          /* of each constraint */
  double *rounding;             /* what rounding may make of what each indicator looks at */
};

static struct Work work_of(const struct Instance *instance) {
  struct Work work = {.change = instance->projection_work};
  work.lack = work.change + lagrangian.coordinate_count;
  work.pivot = work.lack + lagrangian.constraints.count;
  work.slope = work.pivot + lagrangian.constraints.count;
  work.moved = work.slope + lagrangian.constraints.count;
  work.before = work.moved + lagrangian.state_count;
  work.start = work.before + lagrangian.state_count;
  work.first_slope = work.start + lagrangian.state_count;
  work.rounding = work.first_slope + lagrangian.constraints.count;
  return work;
}

/* The largest of the n values from first on, in units of the scales of the state. */
static double size_of(const double *value, const double *state, size_t first) {
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    double size = fabs(value[i]) / scale_of(state, first + i);
    if (!(size <= largest)) largest = size;
  }
  return largest;
}

/* What is to fulfil the constraints: coordinates or velocities, those of a step or of the start. */
enum Target { POSITIONS, VELOCITIES, START_POSITIONS, START_VELOCITIES };

/* Evaluates what the target lacks. False where M is singular, or something is not finite. */
static bool evaluate_lack(struct Instance *instance, double time, const double *state, enum Target target) {
  struct Work work = work_of(instance);
  struct Point point = solver_point(instance, time, state);
  struct Seed seed = {.state = work.moved};
  switch (target) {
  case POSITIONS: instance->singular = lagrangian.constraints.correct_positions(&point, &seed, work.change); break;
  case VELOCITIES: instance->singular = lagrangian.constraints.correct_velocities(&point, work.change); break;
  case START_POSITIONS: instance->singular = lagrangian.constraints.start_positions(&point, &seed, work.change); break;
  case START_VELOCITIES: instance->singular = lagrangian.constraints.start_velocities(&point, work.change); break;
  }
  return instance->singular == 0 && are_finite(work.change, lagrangian.coordinate_count) &&
         are_finite(work.lack, lagrangian.constraints.count);
}

/*
 * Whether all that the coordinates lack is rounding: of gaps of closed contacts, whose terms may be many times as large as the
 * coordinates. Moves by it would be no motion, and methods of variable order would go after it with ever shorter steps.
 */
static bool lacks_only_rounding(struct Instance *instance, double time, const double *state) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Work work = work_of(instance);
  if (switches == NULL || switches->contact_count == 0) return false;
  struct Point point = solver_point(instance, time, state);
  switches->roundings(&point, instance->acceleration, work.rounding);
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t constraint = switches->contacts[i].constraint;
    double rounding = DBL_EPSILON * work.rounding[contact_indicator(switches, i)];
    if (fabs(work.lack[constraint]) <= rounding) work.lack[constraint] = 0.0;
  }
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (work.lack[j] != 0.0) return false;
  return true;
}

static void move_positions(const struct Work *work, double *state, double share) {
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    state[i] += share * work->change[i];
    work->moved[i] += share * work->change[i];
  }
}

static double move_velocities(struct Instance *instance, double time, double *state, enum Target target) {
  size_t n = lagrangian.coordinate_count;
  if (!evaluate_lack(instance, time, state, target)) return INFINITY;
  struct Work work = work_of(instance);
  double size = size_of(work.change, state, n);
  for (size_t i = 0; i < n; i++) state[n + i] += work.change[i];
  return size;
}

/* Whether a constraint that follows from others holds with them: one that only did so at the start may not any more. */
static bool others_hold(const struct Work *work, const double *state, size_t first) {
  double scale = largest_scale(state, first);
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (isinf(work->pivot[j]) && !(fabs(work->lack[j]) <= redundant_lack * work->slope[j] * scale)) return false;
  return true;
}

static bool has_redundant(const struct Work *work) {
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (isinf(work->pivot[j])) return true;
  return false;
}

/* The velocities' part of project(), at coordinates that fulfil the constraints. */
static double project_velocities(struct Instance *instance, double time, double *state) {
  struct Work work = work_of(instance);
  double size = move_velocities(instance, time, state, VELOCITIES);
  if (!isfinite(size) || !has_redundant(&work)) return size;
  bool hold =
      evaluate_lack(instance, time, state, VELOCITIES) && others_hold(&work, state, lagrangian.coordinate_count);
  return hold ? size : INFINITY;
}

/* Frictions alone hold velocities, and leave all coordinates where they are. */
static bool holds_velocities_alone(void) {
  return lagrangian.switches != NULL && lagrangian.constraints.count == lagrangian.switches->friction_count;
}

static double project(struct Instance *instance, double time, double *state) {
  struct Work work = work_of(instance);
  double size = INFINITY, before;
  memcpy(work.start, state, lagrangian.state_count * sizeof *state);
  if (holds_velocities_alone()) return project_velocities(instance, time, state);
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  for (int iteration = 0; iteration < STEP_LIMIT; iteration++) {
    if (!evaluate_lack(instance, time, state, POSITIONS)) return INFINITY;
    before = size;
    size = size_of(work.change, state, 0);
    bool is_rounded = size <= rounded_away && lacks_only_rounding(instance, time, state);
    bool is_done = is_rounded || size <= converged || (size <= rounded_away && size >= before);
    if (is_done && !others_hold(&work, state, 0)) return INFINITY;
    if (!is_rounded) move_positions(&work, state, 1.0);
    if (!is_done) continue;
    double velocities = project_velocities(instance, time, state);
    return fmax(size_of(work.moved, state, 0), velocities);
  }
  return INFINITY;
}

static double drift(struct Instance *instance, double time) {
  struct Work work = work_of(instance);
  memcpy(work.before, instance->state, lagrangian.state_count * sizeof *work.before);
  return project(instance, time, work.before);
}

/* The first constraint that has no finite value. */
static size_t find_without_value(const struct Work *work) {
  size_t j = 0;
  while (j + 1 < lagrangian.constraints.count && isfinite(work->lack[j])) j++;
  return j;
}

/* What a constraint lacks, as a way in units of the state's scale. */
static double way_of(const struct Work *work, size_t constraint, double scale) {
  double lack = work->lack[constraint];
  return lack == 0.0 ? 0.0 : fabs(lack) / (work->slope[constraint] * scale);
}

/* The constraint that lacks most; constraint_count where none lacks anything. */
static size_t find_lacking(const struct Work *work, const double *state, size_t first) {
  size_t worst = lagrangian.constraints.count;
  double scale = largest_scale(state, first), most = fulfilled;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    double way = way_of(work, j, scale);
    if (way > most) {
      most = way;
      worst = j;
    }
  }
  return worst;
}

/* What is left behind it counts first, and then what was lacking before. */
static size_t unkept(struct Instance *instance, double time) {
  struct Work work = work_of(instance);
  int singular = instance->singular;
  size_t found = find_lacking(&work, work.start, 0);
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  if (found == lagrangian.constraints.count && evaluate_lack(instance, time, work.start, POSITIONS))
    found = find_lacking(&work, work.start, 0);
  if (found == lagrangian.constraints.count && evaluate_lack(instance, time, work.start, VELOCITIES))
    found = find_lacking(&work, work.start, lagrangian.coordinate_count);
  instance->singular = singular;
  return found < lagrangian.constraints.count ? found : 0;
}

/*
 * Moves the coordinates onto the constraints from afar, in iterations to the least way, or, where these do not end, to
 * any point on the constraints. False where that fails.
 */
static bool approach_from(struct Instance *instance, double time, double *state, enum Target target, bool least) {
  struct Work work = work_of(instance);
  memcpy(state, work.before, lagrangian.state_count * sizeof *state);
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  for (int iteration = 0; iteration < START_LIMIT; iteration++) {
    if (!least) memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
    if (evaluate_prepare(instance) != STATUS_DONE) return false; /* before the start the pieces follow the state */
    if (!evaluate_lack(instance, time, state, target)) return false;
    double size = size_of(work.change, state, 0);
    move_positions(&work, state, least && size > largest_move ? largest_move / size : 1.0);
    if (size <= converged) return true;
  }
  return false;
}

/* The constraint that cannot be fulfilled; constraint_count for none. */
static size_t approach_positions(struct Instance *instance, double time, double *state, enum Target target) {
  struct Work work = work_of(instance);
  if (!approach_from(instance, time, state, target, true)) approach_from(instance, time, state, target, false);
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  bool has_value = evaluate_prepare(instance) == STATUS_DONE && evaluate_lack(instance, time, state, target);
  if (!has_value) return find_without_value(&work);
  lacks_only_rounding(instance, time, state);
  return find_lacking(&work, state, 0);
}

static size_t approach_velocities(struct Instance *instance, double time, double *state, enum Target target) {
  struct Work work = work_of(instance);
  if (!isfinite(move_velocities(instance, time, state, target))) return 0;
  if (!evaluate_lack(instance, time, state, target)) return 0;
  return find_lacking(&work, state, lagrangian.coordinate_count);
}

/* Those of more than a share of the scale. */
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
    log_message(instance, STATUS_DONE, "time %g: moved to fulfil the constraints: %s%s", instance->situation->time,
                text, length >= 500 ? ", ..." : "");
}

static void log_redundant(const struct Instance *instance, const struct Work *work) {
  for (size_t j = 0; j < lagrangian.constraints.count; j++)
    if (isinf(work->pivot[j]) && work->slope[j] > 0.0) /* one of an open contact has no slope */
      log_message(instance, STATUS_DONE,
                  "time %g: the %s '%s' follows from the others; of all forces that carry the load, theirs are "
                  "the smallest",
                  instance->situation->time, evaluate_kind(j), lagrangian.constraints.names[j]);
}

static bool refuse(struct Instance *instance, size_t constraint, const char *what) {
  struct Work work = work_of(instance);
  if (instance->singular != 0) {
    log_singularity(instance, STATUS_ERROR, instance->situation->time);
    return false;
  }
  const char *name = lagrangian.constraints.names[constraint], *kind = evaluate_kind(constraint);
  if (!isfinite(work.lack[constraint]))
    refuse_call(instance, "the %s '%s' has no finite value at these start values; expected others", kind, name);
  else
    refuse_call(instance,
                "no %s near the start values fulfil the %s '%s' with the others: it is %g where 0 is expected; "
                "expected start values nearer to a solution, fewer of them fixed, or parameters for which there is one",
                what, kind, name, -work.lack[constraint]);
  return false;
}

/*
 * A constraint such as (x^2 + y^2 - l^2)^2 = 0 has no derivatives where it holds, and with them no hold on the motion. The
 * rows of J are held against those of a state nearby. Returns its number; constraint_count for none. state is that of the
 * instance, whose pieces follow it.
 */
static size_t find_vanishing(struct Instance *instance, double time, double *state) {
  struct Work work = work_of(instance);
  size_t n = lagrangian.coordinate_count, found = 0;
  double *there = work.moved; /* which the velocities do not need */
  if (!evaluate_lack(instance, time, state, VELOCITIES)) return lagrangian.constraints.count;
  memcpy(work.first_slope, work.slope, lagrangian.constraints.count * sizeof *work.slope);
  memcpy(there, state, lagrangian.state_count * sizeof *state);
  for (size_t i = 0; i < n; i++) state[i] += (i % 2 == 0 ? 1e-3 : -7e-4) * scale_of(state, i);
  bool has_value = evaluate_prepare(instance) == STATUS_DONE && evaluate_lack(instance, time, state, VELOCITIES);
  memcpy(state, there, lagrangian.state_count * sizeof *state);
  if (evaluate_prepare(instance) != STATUS_DONE || !has_value) return lagrangian.constraints.count;
  while (found < lagrangian.constraints.count &&
         (work.slope[found] == 0.0 || !(work.first_slope[found] <= vanishing * work.slope[found])))
    found++; /* one of an open contact has no slope anywhere */
  return found;
}

static bool refuse_vanishing(struct Instance *instance, size_t constraint) {
  refuse_call(
      instance,
      "the %s '%s' has no derivatives by the coordinates where it holds, so that it cannot hold the "
      "motion; expected it without a square, a root or abs of the whole, or a start away from a singular position",
      evaluate_kind(constraint), lagrangian.constraints.names[constraint]);
  return false;
}

/* Fixed ones that had to move all the same are refused; what rounding has moved is put back. */
static bool keep_fixed(struct Instance *instance, const double *before) {
  size_t n = lagrangian.coordinate_count;
  for (size_t i = 0; i < 2 * n; i++) {
    if (!lagrangian.constraints.coordinate_is_fixed[i % n]) continue;
    if (fabs(instance->state[i] - before[i]) > 1e-9 * scale_of(before, i)) {
      refuse_call(instance,
                  "the constraints hold only where '%s' is %.9g, but its start is fixed at %.9g; expected another "
                  "start value there, or fewer fixed coordinates",
                  evaluate_name(VARIABLE_STATE, i), instance->state[i], before[i]);
      return false;
    }
    instance->state[i] = before[i];
  }
  return true;
}

static bool make_consistent(struct Instance *instance) {
  struct Work work = work_of(instance);
  double time = instance->situation->time;
  bool keeps_fixed = lagrangian.constraints.coordinate_is_fixed != NULL;
  memcpy(work.before, instance->state, lagrangian.state_count * sizeof *work.before);
  size_t lacking = approach_positions(instance, time, instance->state, keeps_fixed ? START_POSITIONS : POSITIONS);
  size_t vanishing_one = find_vanishing(instance, time, instance->state);
  if (vanishing_one < lagrangian.constraints.count) return refuse_vanishing(instance, vanishing_one);
  if (lacking < lagrangian.constraints.count) {
    memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
    evaluate_lack(instance, time, instance->state, POSITIONS);
    return refuse(instance, lacking, "coordinates");
  }
  lacking = approach_velocities(instance, time, instance->state, keeps_fixed ? START_VELOCITIES : VELOCITIES);
  if (lacking < lagrangian.constraints.count) return refuse(instance, lacking, "velocities");
  log_redundant(instance, &work);
  if (keeps_fixed && !keep_fixed(instance, work.before)) return false;
  log_moves(instance, work.before, instance->situation->tolerance);
  return true;
}

/* A coordinate cannot follow an input that jumps. */
static bool has_jumped(struct Instance *instance) {
  struct Work work = work_of(instance);
  double time = instance->situation->time, scale = largest_scale(instance->state, 0);
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  if (lagrangian.constraints.guide_count == 0 || !evaluate_lack(instance, time, instance->state, POSITIONS))
    return false;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    if (lagrangian.constraints.inputs[j] == NULL || way_of(&work, j, scale) <= largest_jump) continue;
    log_message(instance, STATUS_DISCARD,
                "time %g: the %s '%s' is %g where 0 is expected: it depends on %s, and the coordinates cannot "
                "follow a jump; expected inputs that move as their derivatives tell",
                time, evaluate_kind(j), lagrangian.constraints.names[j], -work.lack[j],
                lagrangian.constraints.inputs[j]);
    return true;
  }
  return false;
}

static void log_contradiction(struct Instance *instance, size_t constraint, const char *what) {
  double time = instance->situation->time;
  if (instance->singular != 0) log_singularity(instance, STATUS_DISCARD, time);
  else
    log_message(instance, STATUS_DISCARD,
                "time %g: after a parameter or an input was set, no %s near the present ones fulfil the %s "
                "'%s' with the others: it is %g where 0 is expected; expected values for which there are some",
                time, what, evaluate_kind(constraint), lagrangian.constraints.names[constraint],
                -work_of(instance).lack[constraint]);
}

static bool follow_change(struct Instance *instance) {
  struct Work work = work_of(instance);
  double time = instance->situation->time;
  const char *what = "coordinates";
  if (has_jumped(instance)) return false;
  memcpy(work.before, instance->state, lagrangian.state_count * sizeof *work.before);
  size_t lacking = approach_positions(instance, time, instance->state, POSITIONS);
  if (lacking == lagrangian.constraints.count) {
    what = "velocities";
    lacking = approach_velocities(instance, time, instance->state, VELOCITIES);
  }
  if (lacking == lagrangian.constraints.count) {
    log_moves(instance, work.before,
              lagrangian.constraints.guide_count > 0 ? noted_move : instance->situation->tolerance);
    return true;
  }
  log_contradiction(instance, lacking, what);
  memcpy(instance->state, work.before, lagrangian.state_count * sizeof *work.before);
  return false;
}

static const char *weakest(struct Instance *instance, double time, const double *state) {
  struct Work work = work_of(instance);
  size_t found = 0;
  double least = INFINITY;
  memset(work.moved, 0, lagrangian.state_count * sizeof *work.moved);
  if (!evaluate_lack(instance, time, state, POSITIONS)) return NULL;
  for (size_t j = 0; j < lagrangian.constraints.count; j++) {
    double hold = fabs(work.pivot[j]) / (work.slope[j] * work.slope[j]);
    if (!(hold < least)) continue;
    least = hold;
    found = j;
  }
  return lagrangian.constraints.names[found];
}

const struct Projection projection = {.project = project,
                                      .drift = drift,
                                      .make_consistent = make_consistent,
                                      .follow_change = follow_change,
                                      .unkept = unkept,
                                      .weakest = weakest};
