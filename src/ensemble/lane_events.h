/*
 * Events and constraints of runs in lanes. A step in which no indicator can leave its sign is known by vectors, by the rule
 * of events/search.c; for all else the FMU's own runtime does what it does for one run (single/single_run.h).
 */
#ifndef LANE_EVENTS_H
#define LANE_EVENTS_H

#include "lane_steps.h"
#include "single/single_run.h"

struct LaneEvents {
  struct SingleRun *run;
  struct LaneSteps *steps;
  Mask happens;        /* an event cuts the reach of the lane */
  Lanes time;          /* of it, else the end of the reach */
  Lanes *acceleration; /* of the coordinates, and the forces of constraints */
  Lanes *indicator;    /* CHEBYSHEV_NODES rows */
};

/* False where there is no memory. lane_events_are_needed() tells whether a system has events or constraints. */
bool lane_events_create(struct LaneEvents *events, struct LaneSteps *steps);
void lane_events_destroy(struct LaneEvents *events);
bool lane_events_are_needed(void);

/* From start values to the state and the modes with which runs begin. Returns the lanes in which there are none. */
Mask lane_events_start(struct LaneEvents *events, Mask lanes);

/* Looks for the first event in each reach. Returns the lanes in which that cannot be told. */
Mask lane_events_find(struct LaneEvents *events, Mask active);

/*
 * Lets the lanes go on, which are at the ends of their reaches: behind their events, and on their constraints. Returns those
 * that cannot.
 */
Mask lane_events_go_on(struct LaneEvents *events, Mask active);

/* The accelerations of systems with constraints at a time and at steps->state. Returns the lanes in which there are none. */
Mask lane_events_accelerations(struct LaneEvents *events, Lanes time);

/* Brings steps->state at a time of each lane onto the constraints that hold. Returns the lanes in which that cannot be. */
Mask lane_events_project(struct LaneEvents *events, Lanes time, Mask lanes);

/* Returns the lanes of runs that may not end at a time with steps->state. */
Mask lane_events_may_not_end(struct LaneEvents *events, Lanes time, Mask lanes);

#endif
