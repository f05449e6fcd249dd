/*
 * Communication steps, for all solvers.
 *
 * The solver makes steps of its own length until one reaches the communication point; dense output gives the state
 * there. After each solver step, its events are handled one by one: the step is cut at the event, and the solver
 * restarts after it. A step that cannot be finished ends at the last time with a state, and is discarded. It ends
 * for certain. The number of solver steps or the work is limited, and so are steps in a row that do not change the
 * time.
 */
#include "stepping/steps.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/prescribed_inputs.h"
#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "instance/projection.h"
#include "instance/event_laws.h"
#include "stepping/start.h"

/* The end of a step. */
enum StepResult {
  STEP_DONE,
  STEP_PARTIAL, /* the state is that of a time before the end */
  STEP_FAILED   /* the state is that of the start */
};

/* Consecutive solver steps too short to change the time: more are a singularity, which must not be stepped over. */
enum { RESTING_STEP_LIMIT = 20 };

/* Solver steps and operations (taylor_rule.h) in a communication step that take a good part of a second. */
enum { SLOW_STEPS = 50000 };
static const double SLOW_WORK = 2e9;

/* Evaluations of an event whose work is lagrangian.steps.work.event. */
static const double ROUNDS_OF_EVENT = 2.0;

/* Operations in a communication step if the system sets no maxSteps: about 10 s. */
static const double WORK_LIMIT = 3e10;

/* The part of it that is allowed after events were passed by time steps. */
static const double MORE_WORK = 0.05;

static const char too_much_work[] = "the limit of work in one communication step, about 10 s, is reached; expected a "
                                    "shorter step, or a larger maxSteps of <solver>";
static const char too_many_steps[] = "maxSteps of <solver> is reached in one communication step; expected a shorter "
                                     "step, or a larger maxSteps";
static const char usual_remedy[] = "retrying will not help; restore an earlier state, and use a larger tolerance, "
                                   "other parameters or other coordinates";
static const char explained_remedy[] = "retrying will not help; restore an earlier state, and follow the last message";

/* True if a step contains a time, within the rounding of an importer that adds or multiplies its steps. */
static bool span_contains(const struct Span *span, double time) {
  return solver_step_vanishes(span->start, span->start - time) && solver_step_vanishes(span->end, time - span->end);
}

/*
 * Brings the solver to the start of the step. It continues its last step if that contains the start and nothing was set
 * since; after a restored state it must be able to resume. Otherwise it restarts, from a state that fulfils the
 * constraints.
 */
static enum StepResult prepare_solver(struct Instance *instance, const struct CommunicationStep *step) {
  const struct Solver *solver = lagrangian.solver;
  struct FmuState *fmu_state = instance->fmu_state;
  if (instance->solver_memory == NULL && !solver->create(instance)) return STEP_FAILED;
  bool continues = !solver->starts_anew && fmu_state->changed == CHANGED_NOTHING &&
                   span_contains(&fmu_state->last_step, step->start) &&
                   (!instance->solver_is_stale || solver->resume != NULL);
  if (!continues) {
    fmu_state_begin(fmu_state, step->start);
    /* State or parameters may have been set, unless an event has made all consistent. */
    bool is_resolved = fmu_state->changed == CHANGED_BY_EVENT;
    if (!is_resolved && !start_step(instance)) return STEP_PARTIAL;
    if (solver->restart != NULL && !solver->restart(instance, instance->state, step)) return STEP_FAILED;
  } else if (instance->solver_is_stale) solver->resume(instance);
  instance->solver_is_stale = false;
  fmu_state->changed = CHANGED_NOTHING;
  return STEP_DONE;
}

/* Warns early about slow steps, once an instance. */
static void warn_of_slowness(struct Instance *instance, const struct CommunicationStep *step, double work) {
  if (instance->reported_slowness) return;
  instance->reported_slowness = true;
  log_message(instance, STATUS_WARNING,
              "slow: %s has taken %ld steps from time %.15g to %.15g, and needs to reach %.15g; it stops after %ld, "
              "which maxSteps of <solver> %s",
              lagrangian.solver->name, step->count, step->start, instance->fmu_state->last_step.end, step->end,
              lagrangian.steps.max_steps > 0 ? lagrangian.steps.max_steps
                                             : (long)((double)step->count * WORK_LIMIT / work),
              lagrangian.steps.max_steps > 0 ? "sets" : "can change (default: about 10 s of work)");
}

/* Data of a communication step in progress. */
struct StepProgress {
  struct EventProgress progress;
  int64_t before[STATISTIC_COUNT]; /* the statistics at its start */
  double allowed;                  /* operations beyond the limit, after events were passed by time steps */
  int resting;                     /* consecutive solver steps too short to change the time */
  bool ends_at_event;              /* the motion cannot continue after an event */
};

/* Returns the operations in the communication step. */
static double work_in_step(const struct Instance *instance, const struct CommunicationStep *step,
                           const struct StepProgress *course) {
  const int64_t *present = instance->fmu_state->statistics, *before = course->before;
  double events = (double)(present[STATISTIC_EVENTS] - before[STATISTIC_EVENTS]);
  double rounds = (double)(present[STATISTIC_ROUNDS] - before[STATISTIC_ROUNDS]) / ROUNDS_OF_EVENT;
  return (double)(present[STATISTIC_DERIVATIVES] - before[STATISTIC_DERIVATIVES]) * lagrangian.steps.work.evaluation +
         fmax(events, rounds) * lagrangian.steps.work.event + (double)step->count * lagrangian.steps.work.step;
}

/* Returns NULL, or the limit that is exceeded. */
static const char *excess(const struct CommunicationStep *step, double work, double allowed) {
  if (lagrangian.steps.max_steps == 0) return work < WORK_LIMIT + allowed ? NULL : too_much_work;
  return step->count < lagrangian.steps.max_steps ? NULL : too_many_steps;
}

/* Checks limits of steps and work; warns of slowness. Returns NULL, or the limit that is exceeded. */
static const char *check_cost(struct Instance *instance, const struct CommunicationStep *step,
                              struct StepProgress *course) {
  double work = work_in_step(instance, step, course);
  const char *problem = excess(step, work, course->allowed);
  if (problem != NULL) return problem;
  course->progress.is_slow |= step->count >= SLOW_STEPS || work >= SLOW_WORK;
  if (course->progress.is_slow) warn_of_slowness(instance, step, work);
  return NULL;
}

/* Passes a barrier, if there is one, that the solver cannot reach. Returns NULL, or the reason for a failure. */
static const char *pass_barrier(struct Instance *instance, struct CommunicationStep *step, const char *barrier,
                                struct StepProgress *course) {
  const struct EventLaws *laws = lagrangian.event_laws;
  const char *problem = barrier;
  if (barrier != NULL && laws != NULL) problem = laws->pass_barrier(instance, step, barrier, &course->progress);
  course->ends_at_event = problem != barrier;
  return problem;
}

/*
 * Passes events that would take too much work by time steps. Returns NULL, or the limit that is exceeded, after logging
 * events that have reached it.
 */
static const char *pass_excess(struct Instance *instance, const struct CommunicationStep *step,
                               struct StepProgress *course, const char *problem) {
  const struct EventLaws *laws = lagrangian.event_laws;
  if (laws == NULL) return problem;
  course->allowed = work_in_step(instance, step, course) - (1.0 - MORE_WORK) * WORK_LIMIT;
  if (problem == too_much_work && laws->step_over(instance, step, &course->progress)) return NULL;
  laws->explain(instance, step, &course->progress);
  return problem;
}

/* Makes one solver step, or passes a zero that the solver cannot reach. Returns NULL, or the reason for a failure. */
static const char *advance_once(struct Instance *instance, struct CommunicationStep *step,
                                struct StepProgress *course) {
  const struct Span *last = &instance->fmu_state->last_step;
  const char *problem = check_cost(instance, step, course);
  if (problem != NULL) return pass_excess(instance, step, course, problem);
  struct CommunicationStep near = *step; /* ends sooner if long steps cannot separate the events */
  near.step_limit = course->progress.step_limit;
  if (near.step_limit > 0.0) near.end = fmin(step->end, last->end + near.step_limit);
  problem = pass_barrier(instance, step, lagrangian.solver->advance(instance, &near), course);
  if (problem != NULL) return problem;
  step->count++;
  course->resting = solver_step_vanishes(last->start, last->end - last->start) ? course->resting + 1 : 0;
  return course->resting < RESTING_STEP_LIMIT ? NULL : solver_vanished_step;
}

/* Handles the next event in the solver's last step, which then ends there. Returns NULL, or the reason for stopping. */
static const char *pass_events(struct Instance *instance, struct CommunicationStep *step, struct StepProgress *course) {
  return lagrangian.event_laws != NULL ? lagrangian.event_laws->pass(instance, step, &course->progress) : NULL;
}

static void notify_observer(struct Instance *instance, struct CommunicationStep *step) {
  double time = instance->fmu_state->last_step.end;
  bool is_inside = time > step->start && time < step->end;
  if (instance->observe != NULL && is_inside) instance->observe(instance, step, time);
}

/* Takes the state at the end, and moves it onto the constraints. Returns NULL, or the reason for a failure. */
static const char *take_end(struct Instance *instance, const struct CommunicationStep *step) {
  if (!solver_take_state(instance, step->end)) return "the motion grows without bound";
  return solver_project(instance, step->end, instance->state);
}

/*
 * Makes steps until one reaches the end, whose state is then in instance->state. Returns NULL, or the reason for a
 * failure. *reached: the time up to which the motion is known; it is not known beyond an event that cannot be resolved.
 */
static const char *make_steps(struct Instance *instance, struct CommunicationStep *step, bool *ends_at_event,
                              double *reached) {
  struct StepProgress course = {.progress = {.searched = step->start,
                                             .close_events = instance->fmu_state->close_events,
                                             .looked_ahead = -INFINITY}};
  memcpy(course.before, instance->fmu_state->statistics, sizeof course.before);
  for (;;) {
    const char *problem = pass_events(instance, step, &course);
    *ends_at_event = problem != NULL;
    *reached = course.progress.is_lost ? course.progress.searched : instance->fmu_state->last_step.end;
    if (problem != NULL) return problem;
    notify_observer(instance, step);
    bool is_end = *reached >= step->end;
    problem = is_end ? take_end(instance, step) : advance_once(instance, step, &course);
    if (is_end && problem == NULL) return NULL;
    if (is_end) problem = pass_barrier(instance, step, problem, &course);
    *ends_at_event = problem != NULL && course.ends_at_event;
    /* At the end: no state there is valid, but that at the start of the last step. */
    *reached = is_end ? instance->fmu_state->last_step.start : instance->fmu_state->last_step.end;
    if (problem != NULL) return problem;
  }
}

/* Logs the constraint that is closest to singular, which users look for at the limit of a mechanism. */
static void log_weakest(struct Instance *instance, double time) {
  const struct EventLaws *laws = lagrangian.event_laws;
  const char *name = lagrangian.constraints.projection->weakest(instance, time, instance->state);
  if (name != NULL && (laws == NULL || !laws->holds_at_times(name)))
    log_message(instance, STATUS_DISCARD,
                "time %g: of the constraints, '%s' is closest to singular, as at the limit of a mechanism; constraints "
                "also fail if they contradict each other, jump or have a kink",
                time, name);
}

/*
 * Logs that the solver stopped, with advice. After endless events, or if the laws of events have explained the stop, it
 * names no other solver, since none would help.
 */
static void log_stop(const struct Instance *instance, const struct CommunicationStep *step, const char *reason,
                     bool ends_at_event, bool is_explained, double reached) {
  const struct Solver *solver = lagrangian.solver;
  const char *function = instance->limited_by, *others = ends_at_event || is_explained ? NULL : solver->alternatives;
  const char *remedy = ends_at_event            ? ""
                       : is_explained           ? explained_remedy
                       : solver->remedy != NULL ? solver->remedy
                                                : usual_remedy;
  log_message(instance, STATUS_DISCARD, "%s stopped at time %.15g before %.15g: %s%s%s%s%s%s%s", solver->name, reached,
              step->end, reason, function != NULL && !ends_at_event ? ", by " : "",
              function != NULL && !ends_at_event ? function : "", ends_at_event ? "" : "; ", remedy,
              others != NULL ? ", or build with another <solver>: " : "", others != NULL ? others : "");
}

/* Sets the state to that of the reached time, and logs why it is not the end. */
static enum StepResult stop(struct Instance *instance, const struct CommunicationStep *step, const char *reason,
                            bool ends_at_event, double reached) {
  const struct EventLaws *laws = lagrangian.event_laws;
  size_t violated_constraint = instance->violated_constraint;
  if (!solver_take_state(instance, reached)) return STEP_FAILED;
  /* If the constraints fail, the state stays that of the solver. */
  if (solver_project(instance, reached, instance->state) != NULL && !solver_take_state(instance, reached))
    return STEP_FAILED;
  if (instance->singular != 0) log_singularity(instance, STATUS_DISCARD, reached);
  bool is_explained = ends_at_event || reason == too_much_work || reason == too_many_steps;
  bool is_of_events = !is_explained && laws != NULL && laws->explain_stop(instance, reached);
  is_explained |= is_of_events;
  if (!is_explained && violated_constraint > 0)
    log_violated(instance, STATUS_DISCARD, reached, violated_constraint - 1);
  if (lagrangian.constraints.projection != NULL && !is_explained) log_weakest(instance, reached);
  log_stop(instance, step, reason, ends_at_event, is_of_events, reached);
  instance->fmu_state->changed = CHANGED_VALUES;
  return STEP_PARTIAL;
}

static enum StepResult advance_to_end(struct Instance *instance, struct CommunicationStep *step, double *reached) {
  const struct Span *last = &instance->fmu_state->last_step;
  *reached = step->end;
  if (lagrangian.solver == NULL) return STEP_DONE;
  enum StepResult readiness = prepare_solver(instance, step);
  if (readiness != STEP_DONE) {
    *reached = step->start;
    return readiness;
  }
  bool ends_at_event = false;
  const char *problem = make_steps(instance, step, &ends_at_event, reached);
  bool has_laws = problem == NULL && lagrangian.event_laws != NULL;
  const char *law = has_laws ? lagrangian.event_laws->check(instance, step->end) : NULL; /* violated at the end */
  if (problem == NULL && law == NULL) {
    *reached = step->end; /* an observer may have shortened the step */
    return STEP_DONE;
  }
  if (law != NULL) *reached = last->start;
  if (*reached > step->end) *reached = last->start;
  if (*reached < step->start) *reached = step->start; /* states up to the start were reported already */
  return stop(instance, step, law != NULL ? law : problem, law != NULL || ends_at_event, *reached);
}

/* The arguments and the result of do_advance(), the task of Solver.run(). */
struct Advance {
  struct Instance *instance;
  struct CommunicationStep *step;
  double *reached;
  enum StepResult result;
};

static void do_advance(void *argument) {
  struct Advance *task = argument;
  task->result = advance_to_end(task->instance, task->step, task->reached);
}

/* Runs the step in the solver's error-handling context. */
static enum StepResult run(struct Instance *instance, struct CommunicationStep *step, double *reached) {
  const struct Solver *solver = lagrangian.solver;
  if (solver == NULL || solver->run == NULL) return advance_to_end(instance, step, reached);
  struct Advance task = {.instance = instance, .step = step, .reached = reached};
  if (solver->run(instance, do_advance, &task)) return task.result;
  solver_is_out_of_memory(instance);
  return STEP_FAILED;
}

/*
 * Returns the distance in s by which rounding may take a sum of equal steps from startTime past stopTime. It is
 * half a unit in the last place at each step, and at most half a step.
 */
static double rounding_of_sum(const struct FmuState *fmu_state, double end, double size) {
  double steps = (end - fmu_state->start_time) / size + 1.0;
  return fmin(0.5 * DBL_EPSILON * steps * fmax(fabs(end), fabs(fmu_state->start_time)), 0.5 * size);
}

/* Checks the arguments of a communication step; logs an error. */
static enum Status check_step(struct Instance *instance, double time, double size) {
  const struct FmuState *fmu_state = instance->fmu_state;
  if (!isfinite(time)) return reject_call(instance, "currentCommunicationPoint is %g; expected a finite time", time);
  if (!isfinite(size) || size <= 0.0)
    return reject_call(instance, "the step is %g at time %g; expected a finite one larger than 0", size, time);
  double rounding = 8 * DBL_EPSILON * fabs(time) + 1e-6 * size;
  if (fabs(time - fmu_state->time) > rounding)
    return reject_call(instance, "currentCommunicationPoint is %.15g; expected %.15g, where the instance is", time,
                       fmu_state->time);
  if (time + size <= time)
    return reject_call(instance, "the step %g does not advance the time %g; expected a larger one", size, time);
  if (!isfinite(time + size))
    return reject_call(instance, "the step %g from time %g ends beyond the largest number; expected a shorter one",
                       size, time);
  double allowed = fmax(rounding, rounding_of_sum(fmu_state, time + size, size));
  if (fmu_state->stop_time_defined && time + size - fmu_state->stop_time > allowed)
    return reject_call(instance, "the step ends at %.15g; expected none past stopTime %.15g", time + size,
                       fmu_state->stop_time);
  return STATUS_DONE;
}

/* Returns the step to time + size, or to stopTime if only rounding leads past it. */
static struct CommunicationStep step_within_experiment(const struct FmuState *fmu_state, double time, double size) {
  double stop = fmu_state->stop_time;
  if (fmu_state->stop_time_defined && time < stop && stop < time + size)
    return (struct CommunicationStep){.start = time, .end = stop, .length = stop - time};
  return (struct CommunicationStep){.start = time, .end = time + size, .length = size};
}

enum Status communication_step(struct Instance *instance, double time, double size) {
  struct FmuState *fmu_state = instance->fmu_state;
  if (check_step(instance, time, size) != STATUS_DONE) return STATUS_ERROR;
  if (evaluate_prepare(instance) != STATUS_DONE)
    return reject_call(instance, "the accelerations cannot be computed with these parameters at time %g", time);
  fmu_state->time = time;
  if (!fmu_state->input_derivatives_set)
    memset(instance->input_derivatives, 0, INPUT_ORDER * lagrangian.input_count * sizeof(double));
  struct CommunicationStep step = step_within_experiment(fmu_state, time, size);
  if (instance->request_inputs != NULL) instance->request_inputs(instance, &step);
  if (fmu_state->phase == PHASE_ERROR) return STATUS_ERROR;
  prescribed_inputs_begin_step(instance);
  instance->violated_constraint = 0;
  instance->is_out_of_memory = false;
  double reached = time;
  enum StepResult result = limit_inputs(instance, step.length) ? run(instance, &step, &reached) : STEP_PARTIAL;
  /* Time steps, or a later moment, may have passed an event whose resolution had no memory. */
  if (result == STEP_FAILED || instance->is_out_of_memory)
    return reject_call(instance, "the step from time %g failed", time);
  evaluate_advance_inputs(instance, reached);
  fmu_state->input_derivatives_set = 0;
  fmu_state->time = reached;
  if (result == STEP_DONE) return STATUS_DONE;
  fmu_state->phase = PHASE_STEP_FAILED;
  return STATUS_DISCARD;
}
