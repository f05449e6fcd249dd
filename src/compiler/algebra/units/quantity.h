/* An expression together with its dimension. */
#pragma once

#include "algebra/graph.h"
#include "algebra/units/units.h"

/*
 * A number in the file by which the whole quantity is multiplied, raised to a power: with a unit of its own, which the file
 * cannot give it, it would change the quantity's. NULL as text where there is none.
 */
struct NumberFactor {
  const char *text; /* as written; the name of a <constant> without a unit */
  double power;
};

struct Quantity {
  Node node;
  struct Dimension dimension;
  struct NumberFactor factor;
  bool literal; /* made of numbers alone: takes the unit of what it is added to or compared with */
};
