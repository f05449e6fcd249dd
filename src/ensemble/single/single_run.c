#include "single/single_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/event_laws.h"
#include "methods/taylor_rule.h"
#include "stepping/start.h"

/* Events in a run above which the FMU takes over, which detects Zeno behaviour. */
enum { EVENT_LIMIT = 100000 };

/* State of the event search in each lane. */
struct LaneSearch {
  struct EventProgress progress;
  double *state, *parameter; /* after the last event */
};

/* An instance of the FMU's runtime, into which one lane at a time is loaded. */
struct SingleRun {
  struct Instance instance;
  struct CommunicationStep step; /* the whole run */
  struct LaneSearch *courses;    /* of the lanes; their numbers follow in the same block */
  double origin;                 /* of the series in the lane that was loaded last */
  struct TaylorStep last;        /* this series, of which order, x and low are used */
};

/*
 * --- A solver without steps of its own
 * --------------------------------------------------------------------------------
 */

static bool create_nothing(struct Instance *instance) {
  (void)instance;
  return true;
}

static void destroy_nothing(struct Instance *instance) {
  (void)instance;
}

static bool interpolate_lane(struct Instance *instance, double time, double *state) {
  const struct SingleRun *run = instance->solver_memory;
  double s = time - run->origin;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    state[i] = run->last.x[i][0] + (taylor_change(&run->last, i, s) + run->last.low[i]);
  return true;
}

/* the names in the system's table */
const struct Solver solver_taylor = {
    .name = "a lane", .create = create_nothing, .destroy = destroy_nothing, .interpolate = interpolate_lane};
const struct Solver solver_auto = {
    .name = "a lane", .create = create_nothing, .destroy = destroy_nothing, .interpolate = interpolate_lane};

/* --- Lanes and the instance ------------------------------------------------------------------------------------------- */

static void take_numbers(double *numbers, size_t count, const double *lane, size_t stride) {
  for (size_t i = 0; i < count; i++) numbers[i] = lane[i * stride];
}

static void give_numbers(const double *numbers, size_t count, double *lane, size_t stride) {
  for (size_t i = 0; i < count; i++) lane[i * stride] = numbers[i];
}

static void take_values(struct SingleRun *run, const struct LaneView *lane) {
  struct Instance *instance = &run->instance;
  take_numbers(instance->input, lagrangian.input_count, lane->input, lane->stride);
  take_numbers(instance->parameter, lagrangian.parameter_count, lane->parameter, lane->stride);
}

static void take_state(struct SingleRun *run, const struct LaneView *lane) {
  take_numbers(run->instance.state, lagrangian.state_count, lane->series, SERIES_LENGTH * lane->stride);
}

static void give_state(const double *state, const struct LaneView *lane) {
  give_numbers(state, lagrangian.state_count, lane->series, SERIES_LENGTH * lane->stride);
}

static bool ends_with_zeros(const struct SingleRun *run) {
  for (size_t i = 0; i < lagrangian.state_count; i++)
    if (run->last.x[i][run->last.order] != 0.0) return false;
  return true;
}

/* Copies the lane's polynomials, which interpolate_lane() reads many times. */
static void take_series(struct SingleRun *run, const struct LaneView *lane) {
  run->origin = lane->origin;
  run->last.order = lane->order;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    const double *row = lane->series + i * SERIES_LENGTH * lane->stride;
    take_numbers(run->last.x[i], (size_t)lane->order + 1, row, lane->stride);
    run->last.low[i] = lane->low[i * lane->stride];
  }
  while (run->last.order > 2 && ends_with_zeros(run)) run->last.order--;
}

/* Loads the lane's run into the instance, in its last step. */
static void take(struct SingleRun *run, const struct LaneView *lane) {
  take_values(run, lane);
  take_numbers(run->instance.parameter_constants, lagrangian.parameter_constants_count, lane->parameter_constants,
               lane->stride);
  run->instance.parameter_constants_are_stale = false;
  fmu_state_begin(run->instance.fmu_state, lane->origin);
  run->instance.fmu_state->last_step.end = lane->origin + lane->interval;
}

/* --- The functions ---------------------------------------------------------------------------------------------------- */

bool single_run_is_needed(void) {
  return lagrangian.event_laws != NULL || lagrangian.constraints.projection != NULL;
}

static void *allocate(size_t count, size_t size) {
  return calloc(count, size);
}

struct SingleRun *single_run_create(size_t lanes, double tolerance, double end) {
  size_t numbers = lagrangian.state_count + lagrangian.parameter_count;
  struct SingleRun *run = calloc(1, sizeof *run + lagrangian.state_count * (sizeof(Series) + sizeof(double)));
  struct LaneSearch *courses = calloc(lanes, sizeof *courses + numbers * sizeof(double));
  bool is_created = run != NULL && courses != NULL &&
                    instance_create(&run->instance, KIND_CO_SIMULATION, &(struct Allocator){allocate, free},
                                    &(struct Log){.wanted = 0});
  if (!is_created) {
    free(run);
    free(courses);
    return NULL;
  }
  run->instance.fmu_state->tolerance = tolerance;
  run->step = (struct CommunicationStep){.start = 0.0, .end = end, .length = end};
  run->courses = courses;
  run->last.x = (Series *)(run + 1);
  run->last.low = (double *)(run->last.x + lagrangian.state_count);
  double *number = (double *)(courses + lanes);
  for (size_t i = 0; i < lanes; i++, number += numbers) {
    courses[i].state = number;
    courses[i].parameter = number + lagrangian.state_count;
  }
  return run;
}

void single_run_destroy(struct SingleRun *run) {
  if (run == NULL) return;
  run->instance.solver_memory = NULL;
  instance_destroy(&run->instance);
  free(run->courses);
  free(run);
}

bool single_run_start(struct SingleRun *run, const struct LaneView *lane) {
  struct Instance *instance = &run->instance;
  double tolerance = instance->fmu_state->tolerance;
  instance_reset(instance);
  instance->fmu_state->tolerance = tolerance;
  instance->fmu_state->stop_time_defined = 1;
  instance->fmu_state->stop_time = run->step.end;
  instance->fmu_state->phase = PHASE_INITIALIZATION;
  take_values(run, lane);
  take_state(run, lane);
  instance->parameter_constants_are_stale = true;
  if (start_find(instance) != STATUS_DONE) return false;
  instance->fmu_state->phase = PHASE_STEP_COMPLETE;
  if (evaluate_prepare(instance) != STATUS_DONE || !start_step(instance)) return false;
  instance->solver_memory = run;
  give_state(instance->state, lane);
  give_numbers(instance->parameter, lagrangian.parameter_count, lane->parameter, lane->stride);
  run->courses[lane->number].progress = (struct EventProgress){.searched = run->step.start, .looked_ahead = -INFINITY};
  return true;
}

enum LaneEvent single_run_find_event(struct SingleRun *run, const struct LaneView *lane, double *time) {
  struct Instance *instance = &run->instance;
  struct LaneSearch *course = &run->courses[lane->number];
  const struct Span *last = &instance->fmu_state->last_step;
  if (course->progress.count >= EVENT_LIMIT) return EVENT_UNKNOWN;
  take(run, lane);
  take_series(run, lane);
  instance->solver_memory = run;
  if (lagrangian.event_laws->pass(instance, &run->step, &course->progress) != NULL) return EVENT_UNKNOWN;
  if (last->end > last->start) return NO_EVENT;
  *time = last->end;
  memcpy(course->state, instance->event_state, lagrangian.state_count * sizeof *course->state);
  memcpy(course->parameter, instance->parameter, lagrangian.parameter_count * sizeof *course->parameter);
  return EVENT;
}

double single_run_searched(const struct SingleRun *run, size_t lane) {
  return run->courses[lane].progress.searched;
}

void single_run_pass_quietly(struct SingleRun *run, const struct LaneView *lane) {
  struct EventProgress *progress = &run->courses[lane->number].progress;
  progress->searched = fmax(progress->searched, fmin(lane->origin + lane->interval, run->step.end));
  progress->close_events = progress->nearer = 0;
}

void single_run_continue(struct SingleRun *run, const struct LaneView *lane) {
  const struct LaneSearch *course = &run->courses[lane->number];
  give_state(course->state, lane);
  give_numbers(course->parameter, lagrangian.parameter_count, lane->parameter, lane->stride);
  for (size_t i = 0; i < lagrangian.state_count; i++) lane->low[i * lane->stride] = 0.0;
}

/* Projects the instance's state onto the constraints. */
static bool project(struct SingleRun *run, const struct LaneView *lane, double time) {
  take(run, lane);
  return solver_project(&run->instance, time, run->instance.state) == NULL;
}

bool single_run_project(struct SingleRun *run, const struct LaneView *lane, double time, double *state) {
  take_numbers(run->instance.state, lagrangian.state_count, state, lane->stride);
  bool is_done = project(run, lane, time);
  give_numbers(run->instance.state, lagrangian.state_count, state, lane->stride);
  return is_done;
}

bool single_run_keep_constraints(struct SingleRun *run, const struct LaneView *lane) {
  take_state(run, lane);
  bool is_done = project(run, lane, lane->origin);
  give_state(run->instance.state, lane);
  return is_done;
}

bool single_run_may_end(struct SingleRun *run, const struct LaneView *lane, double time, const double *state) {
  if (lagrangian.event_laws == NULL) return true;
  take(run, lane);
  take_numbers(run->instance.state, lagrangian.state_count, state, lane->stride);
  return lagrangian.event_laws->check(&run->instance, time) == NULL;
}
