/*
 * Units of measurement as products of powers of the SI base units and the radian (FMI 2.0.4, section 2.2.2).
 * Only coherent units are known: a quantity in one of them needs no conversion factor.
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
 * Reads a unit such as "kg.m2/s2", "N.m/rad" or "N/(m.s)". Returns false and leaves an explanation in *problem
 * (a static string) where the text is no coherent unit.
 */
bool unit_parse(const char *text, struct Dimension *dimension, const char **problem);

/* The exponent behind a unit's name, as in s-1 or Pa0.5, behind which the text then is; 1 where there is none. */
double unit_exponent(const char **text);

/* The dimension of a unit that is right. */
struct Dimension unit_of(const char *text);

/* The unit in base units, for example "kg.m2/s2"; "1" without any. */
char *unit_text(struct Dimension dimension);

/* first * second^power; unknown where either is. */
struct Dimension dimension_multiply(struct Dimension first, struct Dimension second, double power);

/* Whether all exponents are whole numbers, as FMI asks for; false where unknown. */
bool dimension_is_whole(struct Dimension dimension);

/* How a message goes on about a quantity of the unit 1 where another is expected, such as cos(a) for a length; else "". */
const char *unit_hint(struct Dimension dimension);

/* Whether both are the same quantity; the radian counts as 1, unknown agrees with all. */
bool dimension_agrees(struct Dimension first, struct Dimension second);
