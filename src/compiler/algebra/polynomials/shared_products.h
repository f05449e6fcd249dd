/* Common factors of products, computed once, as x y in x y z + x w y. Values change only by rounding. */
#pragma once

#include "algebra/graph.h"

/* Groups the factors of products in sums of the nodes, by pairs that occur repeatedly in the leading ones. */
void share_products(struct Graph *graph, size_t leading, size_t count, Node *nodes);
