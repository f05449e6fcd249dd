/*
 * Guard conditions of the nodes in a series. GUARD(a, b) is b where a > 0, else 0. A node that is needed only under
 * guards whose conditions do not hold may have no value, and must not limit the step.
 */
#pragma once

#include "program/expressions/series_plan.h"

/* Guard conditions kept for a node; with more, it counts as always needed, which only shortens steps. */
enum { GUARD_CONDITION_LIMIT = 6 };

/*
 * The guard conditions, of which at least one must be positive for the node to be needed. always: needed in any case,
 * also if it has more conditions than the limit.
 */
struct GuardConditions {
  Node nodes[GUARD_CONDITION_LIMIT];
  size_t count;
  bool always;
};

/* Returns the guard conditions of each node of the graph; NULL without guards. */
struct GuardConditions *guard_conditions_of(const struct Graph *graph, const struct SeriesPlan *plan);
