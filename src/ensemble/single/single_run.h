/*
 * The FMU's own runtime, for what is done lane by lane: starts, events and constraints. It sees a lane as a run whose
 * solver's last step are the series of the lane.
 */
#ifndef SINGLE_RUN_H
#define SINGLE_RUN_H

#include <stdbool.h>
#include <stddef.h>

/* The numbers of one lane, each of which lies so many behind the one before it. */
struct LaneView {
  size_t number; /* of the lane */
  size_t stride;
  int order;
  double origin, reach; /* of the series */
  double *series;       /* state_count rows of SERIES_LENGTH coefficients */
  double *low;          /* state_count: what rounding left of the state at the origin */
  double *parameter, *prepared, *input;
};

/* What the next event does to a lane. */
enum LaneEvent {
  NO_EVENT,     /* none up to the end of the reach */
  EVENT,        /* the lane goes on from its time with what single_run_go_on() gives it */
  EVENT_UNKNOWN /* it cannot be told: the run is one for the FMU alone */
};

struct SingleRun;

/* For runs in so many lanes, from time 0 to an end. NULL where there is no memory. */
struct SingleRun *single_run_create(size_t lanes, double tolerance, double end);
void single_run_destroy(struct SingleRun *run);

/* Whether lanes have anything for the functions below to do. */
bool single_run_is_needed(void);

/*
 * From the start values in a lane to the state and the modes with which its run begins. False where there are none; the FMU
 * says why.
 */
bool single_run_start(struct SingleRun *run, const struct LaneView *lane);

/* The first event in the reach of the lane, with its time, by the rules of events/passing.c. */
enum LaneEvent single_run_find_event(struct SingleRun *run, const struct LaneView *lane, double *time);

/* Tells that there is no event in the reach. */
void single_run_pass_quietly(struct SingleRun *run, const struct LaneView *lane);

/* Lets the lane have the state and the modes behind the event that was found in it last. */
void single_run_go_on(struct SingleRun *run, const struct LaneView *lane);

/* Up to which time events were looked for in the lane. */
double single_run_searched(const struct SingleRun *run, size_t lane);

/*
 * Brings a state at a time in the reach back to the constraints that hold in the lane. False where that cannot be. The state's
 * numbers lie as those of the lane.
 */
bool single_run_project(struct SingleRun *run, const struct LaneView *lane, double time, double *state);

/* The same with the state at the origin. */
bool single_run_keep_constraints(struct SingleRun *run, const struct LaneView *lane);

/* Whether what must hold where a run ends does so at a time and a state, whose numbers lie likewise. */
bool single_run_may_end(struct SingleRun *run, const struct LaneView *lane, double time, const double *state);

#endif
