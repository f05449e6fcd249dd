/*
 * Products of the same factors, computed once: in x y z + x w y, x y is one node. How a product is grouped does not change it but by
 * rounding.
 */
#pragma once

#include "algebra/graph.h"

/* Groups the factors of products in the sums of the nodes by pairs that the first, leading ones share. */
void share_products(struct Graph *graph, size_t leading, size_t count, Node *nodes);
