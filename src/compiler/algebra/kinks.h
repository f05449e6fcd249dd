/* Where functions turn or jump. */
#pragma once

#include "algebra/graph.h"

/*
 * The name of a function with a kink or a jump, such as "min", below the nodes; NULL for none. Its pieces have series,
 * which end where the next piece begins.
 */
const char *kink_of(const struct Graph *graph, const Node *nodes, size_t count);

/* The same for a kink that no series sees, as that of asin(sin(x)). */
const char *kink_without_series_of(const struct Graph *graph, const Node *nodes, size_t count);
