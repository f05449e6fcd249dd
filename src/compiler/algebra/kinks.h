/* Kinks and jumps of functions. */
#pragma once

#include "algebra/graph.h"

/*
 * Returns the name of a function below the nodes that has a kink or a jump, such as "min"; NULL for none. Each of its
 * pieces has a series, which ends at the next one.
 */
const char *kink_of(const struct Graph *graph, const Node *nodes, size_t count);

/* Returns the name of a kink that no series shows, such as that of asin(sin(x)); NULL for none. */
const char *kink_without_series_of(const struct Graph *graph, const Node *nodes, size_t count);
