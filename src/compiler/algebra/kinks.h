/* Kinks and jumps of functions. */
#pragma once

#include "algebra/graph.h"

/*
 * Returns the name of a function below the nodes that has a kink or a jump, such as "min"; NULL for none. The function
 * has a series on each of its pieces; a step ends at the boundary of two pieces.
 */
const char *kink_of(const struct Graph *graph, const Node *nodes, size_t count);

/* Returns the name of a kink that cannot be located, such as that of asin(sin(x)); NULL for none. */
const char *kink_without_series_of(const struct Graph *graph, const Node *nodes, size_t count);
