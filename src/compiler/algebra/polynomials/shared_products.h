/*
 * Common factors of products, computed once: in x y z + x w y, x y is one node. Grouping changes a product by rounding
 * alone.
 */
#pragma once

#include "algebra/graph.h"

/*
 * Groups the factors of products in sums of the nodes, by the pairs that occur more than once in the first `leading`
 * nodes.
 */
void share_products(struct Graph *graph, size_t leading, size_t count, Node *nodes);
