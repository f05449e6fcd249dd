/* The expressions whose Taylor series are computed. */
#pragma once

#include "mechanics/equations.h"
#include "algebra/node_list.h"

/*
 * The targets are the accelerations, the rates of first-order states, and the auxiliary nodes of recurrences, such
 * as cos(x) for sin(x). For blocks that are factored at run time, M and the right side replace the accelerations.
 */
struct SeriesPlan {
  struct NodeList targets;
  size_t root_count; /* the first targets, which are no auxiliary nodes */
  Node *slope;       /* for each node of the graph: its time derivative if it is linear in time, else ZERO */
  Node *auxiliary;   /* for each node of the graph: the auxiliary node of its recurrence, see functions.h; ZERO: none */
};

/* Returns the plan of the motion. The equations must have no kink without a series. */
struct SeriesPlan *series_plan_of_motion(struct Graph *graph, const struct Equations *equations);

/* Returns the plan of further expressions, which must have no kink without a series. */
struct SeriesPlan *series_plan_of_outputs(struct Graph *graph, const Node *outputs, size_t count);
