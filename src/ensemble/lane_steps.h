/*
 * Taylor series of several runs, a lane for each: what methods/taylor.c does for one run, by the same rule
 * (methods/taylor_rule.h). All have one order, as it follows from the tolerance, and each has its own time and step.
 */
#ifndef LANE_STEPS_H
#define LANE_STEPS_H

#include "lane_system.h"

struct LaneSteps {
  void *memory; /* of all rows */
  int order;
  double margin;                           /* see taylor_rule.h */
  double tolerance;                        /* relative */
  double longest;                          /* that a step may be */
  double length;                           /* of the runs */
  Lanes origin, reach;                     /* of the series: their time and how far they are right */
  Lanes *parameter, *prepared, *constants; /* constants: the inputs */
  Lanes *unit; /* one over the size of each state variable, or over its nominal value where that is larger */
  Lanes *low;  /* what rounding left of the state at the origin */
  Series *x, *input, *work;   /* x[i][0] is the state at the origin */
  Lanes *derivative, *change; /* at the end of the reach, where they were measured; see taylor.h */
  Lanes *state, *rate;        /* a state that is looked at, and scratch */
  Lanes *point_work;          /* of generated functions */
  Mask is_limited;            /* the step is short for another reason than the size of its coefficients */
  Lanes fast;                 /* how many of the last steps fast modes may have bounded, one after another */
  Lanes path, steps;          /* of the last steps that are not, how far they moved the state, and how many */
};

/* Rows for everything; false where there is no memory. */
bool lane_steps_create(struct LaneSteps *steps, double tolerance, double length);
void lane_steps_destroy(struct LaneSteps *steps);

/*
 * Takes up what lanes have at the origin: the values of their parameters and inputs, and x[i][0]. For the other lanes it
 * computes again what they have. Returns the lanes that refuse a parameter.
 */
Mask lane_steps_start(struct LaneSteps *steps);

/* The series about the origin and their reach, 0 in lanes that are not active. Returns those in which there is none. */
Mask lane_steps_expand(struct LaneSteps *steps, Mask active);

/* Moves the origin to the end of the reach. Returns the lanes in which many steps have hardly moved the state. */
Mask lane_steps_move(struct LaneSteps *steps);

/* For generated functions, at a time and at steps->state. */
struct Point lane_steps_point(const struct LaneSteps *steps, Lanes time);

/* steps->state at a time within the reach. */
void lane_steps_take_state(struct LaneSteps *steps, Lanes time);

#endif
