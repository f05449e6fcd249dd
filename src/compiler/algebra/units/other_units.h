/* Units of the world that are not coherent, and how a value in them is given in SI units instead. */
#pragma once

/*
 * What to write instead of a unit that unit_parse() refuses, for example "expected kg/m3, and the value times 1e3" for
 * "g/cm3"; NULL where that is not known.
 */
char *unit_remedy(const char *text);
