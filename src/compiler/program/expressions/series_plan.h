/* What Taylor series of the motion need beside the equations themselves. */
#pragma once

#include "mechanics/equations.h"
#include "algebra/node_list.h"

/*
 * The nodes whose series are computed: accelerations (or M and the right side of large blocks), the power of the
 * forces where its work is asked for, and the auxiliary nodes that recurrences rest on, such as cos(x) for sin(x).
 */
struct SeriesPlan {
  struct NodeList targets;
  size_t root_count; /* of the targets, those that are no auxiliary nodes */
  Node
      *slope; /* for each node of the graph: its constant time derivative where it is linear in time; ZERO: it is not */
  Node *auxiliary; /* for each node of the graph, the node that its recurrence rests on, see functions.h; ZERO: none */
};

/* For the motion; the equations have no kink without a series. */
struct SeriesPlan *series_plan_of_motion(struct Graph *graph, const struct Equations *equations);

/* For expressions of the motion, without kinks. */
struct SeriesPlan *series_plan_of_outputs(struct Graph *graph, const Node *outputs, size_t count);
