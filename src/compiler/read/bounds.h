/*
 * Bounds of expressions by interval arithmetic (R. E. Moore: Interval Analysis, 1966): each operation maps the bounds
 * of its operands. Bounds that are found contain every value; a symbol that occurs twice makes them wider than
 * necessary.
 */
#pragma once

#include "model/model.h"

/* Values of an expression; low and high may be infinite. */
struct Bounds {
  double low, high;
};

/* A node, and bounds of it that are known. */
struct KnownBounds {
  Node node;
  struct Bounds bounds;
};

/*
 * Returns bounds of the values for all coordinates, velocities, states, times and inputs, and parameters in their
 * ranges. known[count]: bounds of nodes, which replace those by interval arithmetic.
 */
struct Bounds bounds_of(const struct Model *model, Node node, const struct KnownBounds *known, size_t count);
