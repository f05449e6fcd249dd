/*
 * Events and constraints of runs in lanes. A vectorized test proves for most steps that no indicator changes its sign,
 * by the criterion of detection/search.c. For other lanes, the FMU's own runtime handles one run after another
 * (single/single_run.h).
 */
#pragma once

#include "lane_steps.h"
#include "single/single_run.h"

/* Events of the runs in lanes. `run` handles the lanes that have events, one after another. */
struct LaneEvents {
  struct SingleRun *run;
  struct LaneSteps *steps;
  Mask happens;        /* an event ends the lane's step */
  Lanes time;          /* time of the event, else the end of the step */
  void *memory;        /* memory of all rows */
  Lanes *acceleration; /* of the coordinates, then the forces of the constraints */
  Lanes *indicator;    /* CHEBYSHEV_NODES rows */
};

/* Returns false if memory is exhausted. */
bool lane_events_create(struct LaneEvents *events, struct LaneSteps *steps);
void lane_events_destroy(struct LaneEvents *events);

/* True if the system has events or constraints. */
bool lane_events_are_needed(void);

/* Finds the first state and modes from the start values. Returns the lanes in which that fails. */
Mask lane_events_start(struct LaneEvents *events, Mask lanes);

/* Finds the first event in each step. Returns the lanes in which that fails. */
Mask lane_events_find(struct LaneEvents *events, Mask active);

/*
 * Prepares the next steps: sets the state and modes after events, and projects the state onto the constraints.
 * Returns the lanes in which that fails.
 */
Mask lane_events_continue(struct LaneEvents *events, Mask active);

/*
 * Computes accelerations and forces of a constrained system at steps->step.state. Returns the lanes in which that
 * fails.
 */
Mask lane_events_accelerations(struct LaneEvents *events, Lanes time);

/* Projects steps->step.state at each lane's time onto its closed constraints. Returns the lanes in which that fails. */
Mask lane_events_project(struct LaneEvents *events, Lanes time, Mask lanes);

/* Returns the lanes in which the checks at the end of a run fail for steps->step.state. */
Mask lane_events_check_end(struct LaneEvents *events, Lanes time, Mask lanes);
