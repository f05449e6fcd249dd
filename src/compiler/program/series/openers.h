/*
 * Under which gates a node of a series matters: where all of them are closed, it may have no value, and must not shorten a
 * step.
 */
#pragma once

#include "program/expressions/series_plan.h"

enum { OPENER_LIMIT = 6 };

/* The openers of the gates, one of which must be open; with more than the limit, or without a gate, it always matters. */
struct Openers {
  Node nodes[OPENER_LIMIT];
  size_t count;
  bool always;
};

/* One for each node of the graph; NULL where there are no gates. */
struct Openers *openers_of(const struct Graph *graph, const struct SeriesPlan *plan);
