/* Common units that are not coherent SI units, and their conversion. */
#pragma once

#include "algebra/units/units.h"

/* The relation of a unit to the coherent unit of its dimension; only degC has an offset. */
struct UnitScale {
  double factor, offset;
};

/*
 * Returns the remedy for a unit that unit_parse() rejects, such as "expected kg/m3, and the value times 1e3" for
 * "g/cm3"; NULL if there is none.
 */
char *unit_remedy(const char *text);

/*
 * Reads a display unit, such as "deg", "rpm", "mm/s", "N.mm" or "degC". A value x in it is factor * x + offset in
 * the coherent unit of its dimension. False if the text is no unit, or a coherent one.
 */
bool display_unit_parse(const char *text, struct Dimension *dimension, struct UnitScale *scale);
