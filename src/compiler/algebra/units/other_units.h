/* Units of the world that are not coherent, and how a value in them is given in SI units instead. */
#pragma once

#include "algebra/units/units.h"

/*
 * What to write instead of a unit that unit_parse() refuses, for example "expected kg/m3, and the value times 1e3" for
 * "g/cm3"; NULL where that is not known.
 */
char *unit_remedy(const char *text);

/*
 * Reads a unit for display, such as "deg", "rpm", "mm/s" or "N.mm": one of it is *factor of the coherent unit of its dimension.
 * False where the text is no unit, or a coherent one.
 */
bool display_unit_parse(const char *text, struct Dimension *dimension, double *factor);
