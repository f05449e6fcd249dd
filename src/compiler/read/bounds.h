/*
 * Bounds of expressions by interval arithmetic (R. E. Moore: Interval Analysis, 1966): each operation maps the bounds of
 * its operands. Bounds that are found contain every value; a symbol that occurs twice makes them wider than necessary.
 */
#pragma once

#include "model/model.h"

/* Values of an expression; low and high may be infinite. */
struct Bounds {
  double low, high;
};

/*
 * Returns bounds of the values for all coordinates, velocities, states, times and inputs, and parameters in their ranges.
 * indicators: bounds of the indicators of all branches, whose signs are their modes; NULL for any signs.
 */
struct Bounds bounds_of(const struct Model *model, Node node, const struct Bounds *indicators);
