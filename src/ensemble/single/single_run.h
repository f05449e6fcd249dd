/*
 * The FMU's own runtime, for lanes one by one: starts, events and constraints. It treats a lane as a run whose last
 * step has the lane's series.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The numbers of one lane: consecutive ones are stride apart. */
struct LaneView {
  size_t number; /* index of the lane */
  size_t stride;
  int order;
  double origin, interval; /* time of the series' origin, and length of their step, in s */
  double *series;          /* state_count rows of SERIES_LENGTH coefficients */
  double *low;             /* state_count: compensation of the state at the origin */
  double *parameter, *parameter_constants, *input;
};

/* The result of a search for an event. */
enum LaneEvent {
  NO_EVENT,     /* none up to the end of the step */
  EVENT,        /* the lane continues with single_run_continue() */
  EVENT_UNKNOWN /* the search failed, and the FMU must do the run */
};

struct SingleRun;

/* Creates the state of runs from time 0 to end, in s. Returns NULL if memory is exhausted. */
struct SingleRun *single_run_create(size_t lanes, double tolerance, double end);
void single_run_destroy(struct SingleRun *run);

/* True if the system has events or constraints; otherwise the functions below are not needed. */
bool single_run_is_needed(void);

/* Finds the first state and modes from a lane's start values. Returns false if that fails; the FMU reports why. */
bool single_run_start(struct SingleRun *run, const struct LaneView *lane);

/* Finds the first event in the lane's step and its time, by the rules of events/passing.c. */
enum LaneEvent single_run_find_event(struct SingleRun *run, const struct LaneView *lane, double *time);

/* Records that the step has no event. */
void single_run_pass_quietly(struct SingleRun *run, const struct LaneView *lane);

/* Stores the state and modes after the last found event in the lane. */
void single_run_continue(struct SingleRun *run, const struct LaneView *lane);

/* Returns the time up to which the lane was searched for events. */
double single_run_searched(const struct SingleRun *run, size_t lane);

/*
 * Projects a state at a time in the step onto the closed constraints. The state has the stride of the lane. Returns
 * false if that fails.
 */
bool single_run_project(struct SingleRun *run, const struct LaneView *lane, double time, double *state);

/* Does the same with the state at the origin. */
bool single_run_keep_constraints(struct SingleRun *run, const struct LaneView *lane);

/* True if the checks at the end of a run succeed at this time and state, which has the stride of the lane. */
bool single_run_may_end(struct SingleRun *run, const struct LaneView *lane, double time, const double *state);
