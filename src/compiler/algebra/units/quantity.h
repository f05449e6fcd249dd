/* An expression together with its dimension. */
#pragma once

#include "algebra/graph.h"
#include "algebra/units/units.h"

struct Quantity {
  Node node;
  struct Dimension dimension;
  bool literal; /* made of numbers alone: agrees with any dimension in a sum */
};
