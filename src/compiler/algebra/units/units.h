/*
 * Units of measurement as products of powers of the SI base units and the radian (FMI 2.0.4, section 2.2.2). Only
 * coherent units are accepted: they need no conversion factor.
 */
#pragma once

#include <stdbool.h>

enum { KILOGRAM, METRE, SECOND, AMPERE, KELVIN, MOLE, CANDELA, RADIAN, BASE_UNIT_COUNT };

/* The exponents of the base units; an unknown dimension agrees with every other one. */
struct Dimension {
  bool known;
  double exponent[BASE_UNIT_COUNT];
};

extern const char *const base_unit_names[BASE_UNIT_COUNT];
extern const struct Dimension dimension_unknown, dimension_one;

/*
 * Reads a unit such as "kg.m2/s2", "N.m/rad" or "N/(m.s)". If the text is no coherent unit, returns false and sets
 * *problem to a static explanation.
 */
bool unit_parse(const char *text, struct Dimension *dimension, const char **problem);

/* Returns the exponent after a unit's name, as in s-1 or Pa0.5, and moves *text past it; 1 if there is none. */
double unit_exponent(const char **text);

/* Returns the dimension of a valid unit. */
struct Dimension unit_of(const char *text);

/* Returns the dimension in base units, such as "kg.m2/s2"; "1" without any. */
char *unit_text(struct Dimension dimension);

/* Returns first * second^power; unknown if either is. */
struct Dimension dimension_multiply(struct Dimension first, struct Dimension second, double power);

/* True if all exponents are whole, as FMI requires; false if unknown. */
bool dimension_is_whole(struct Dimension dimension);

/* Returns a hint for a quantity of unit 1 where another is expected, such as cos(a) for a length; else "". */
const char *unit_hint(struct Dimension dimension);

/* True if both are the same quantity. The radian counts as 1; an unknown dimension agrees with any. */
bool dimension_agrees(struct Dimension first, struct Dimension second);
