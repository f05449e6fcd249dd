/* Common units that are not coherent SI units, and their conversion. */
#pragma once

#include "algebra/units/units.h"

#define CELSIUS_ZERO 273.15 /* K */

/* True for the degree Celsius, whose zero is not that of the kelvin. */
bool is_celsius(const char *text);

/*
 * Returns the remedy for a unit that unit_parse() rejects, such as "expected kg/m3, and the value times 1e3" for
 * "g/cm3"; NULL if there is none.
 */
char *unit_remedy(const char *text);

/*
 * Reads a display unit, such as "deg", "rpm", "mm/s" or "N.mm": 1 of it is *factor of the coherent unit of its
 * dimension. False if the text is no unit, or a coherent one.
 */
bool display_unit_parse(const char *text, struct Dimension *dimension, double *factor);
