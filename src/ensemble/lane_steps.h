/*
 * The Taylor method for several runs, a vector lane for each: the algorithm of methods/taylor.c and taylor_interval.c
 * with the same step (methods/taylor_rule.h) and defect (methods/taylor_defect.h). All lanes share the order, which
 * follows from the tolerance; each has its own time and step. Branches become masks, so that a lane's results do not
 * depend on other lanes.
 */
#pragma once

#include "lane_functions.h"
#include "lane_system.h"
#include "methods/taylor_rule.h"

/* The runs in lanes. Rows have one vector for each state variable or coefficient; all rows are parts of memory. */
struct LaneSteps {
  struct TaylorStep step;
  void *memory;     /* memory of all rows */
  double margin;    /* see taylor_rule.h */
  double tolerance; /* relative, of the runs */
  double longest;   /* longest step, in s */
  double length;    /* length of the runs, in s */
  /* time of the series' origin, and length of the step in which they are valid, in s */
  Lanes origin, interval;
  Lanes *parameter, *parameter_constants, *constants; /* constants: the inputs, which are constant in a run */
  Series *input, *work; /* coefficients of the inputs; workspace of lagrangian.taylor.series */
  Lanes *point_work;    /* workspace of generated functions */
  Lanes *start;         /* of the variables of lagrangian.following: start values that follow from parameters */
  Lanes fast;           /* number of consecutive steps, up to the last, that fast modes may have limited */
  Lanes path, steps;    /* of recent steps that the coefficients limit: sum of the state's changes, and number */
};

/* Allocates rows of 0, aligned; free(*memory) releases them. Returns NULL if memory is exhausted. */
Lanes *lane_rows(size_t count, void **memory);

/* Allocates all rows. Returns false if memory is exhausted. */
bool lane_steps_create(struct LaneSteps *steps, double tolerance, double length);
void lane_steps_destroy(struct LaneSteps *steps);

/*
 * Prepares parameters, and evaluates the derivatives at the origin, in all lanes; unchanged lanes get the same values
 * again. Returns the lanes that reject a parameter.
 */
Mask lane_steps_start(struct LaneSteps *steps);

/*
 * Computes the series about the origin and their interval of validity; 0 in inactive lanes. Returns the lanes that need
 * the FMU.
 */
Mask lane_steps_expand(struct LaneSteps *steps, Mask active);

/* Moves the origin to the end of the step. Returns the lanes that stagnate. */
Mask lane_steps_move(struct LaneSteps *steps);

/* Returns the point of generated functions at a time and at step.state. */
struct Point lane_steps_point(const struct LaneSteps *steps, Lanes time);

/* Evaluates the state at a time within the step into step.state. */
void lane_steps_take_state(struct LaneSteps *steps, Lanes time);
