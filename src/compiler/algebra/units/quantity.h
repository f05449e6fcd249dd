/* An expression together with its dimension. */
#pragma once

#include "algebra/graph.h"
#include "algebra/units/units.h"

/*
 * A number in system.xml that multiplies the whole quantity, raised to a power. It may stand for a value with a unit
 * that the file does not give; messages name it. text is NULL if there is none.
 */
struct NumberFactor {
  const char *text; /* as written; the name of a <constant> without a unit */
  double power;
};

/* A value of the reader: its node, its dimension, and what messages about units need. */
struct Quantity {
  Node node;
  struct Dimension dimension;
  struct NumberFactor factor;
  bool literal;    /* made of plain numbers: takes the unit of the quantity that it is added to or compared with */
  Node at_instant; /* for <set>: a definition with floor, ceil, round and mod as plain values; ZERO without pieces */
  Node whole;      /* the same with all piecewise functions as plain values */
};
