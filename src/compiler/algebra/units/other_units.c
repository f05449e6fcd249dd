#include "algebra/units/other_units.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define CELSIUS_ZERO 273.15 /* K */

/* 1 of the unit is factor * pi^pi_power of the SI unit. */
struct OtherUnit {
  const char *name, *si;
  double factor;
  int pi_power;
};

static const struct OtherUnit others[] = {
    {"deg", "rad", 1.0 / 180, 1},
    {"degree", "rad", 1.0 / 180, 1},
    {"degrees", "rad", 1.0 / 180, 1},
    {"\xc2\xb0", "rad", 1.0 / 180, 1},
    {"%", "1", 1e-2, 0},
    {"mm", "m", 1e-3, 0},
    {"cm", "m", 1e-2, 0},
    {"km", "m", 1e3, 0},
    {"g", "kg", 1e-3, 0},
    {"ms", "s", 1e-3, 0},
    {"min", "s", 60, 0},
    {"h", "s", 3600, 0},
    {"kN", "N", 1e3, 0},
    {"inch", "m", 0.0254, 0},
    {"in", "m", 0.0254, 0},
    {"ft", "m", 0.3048, 0},
    {"um", "m", 1e-6, 0},
    {"l", "m3", 1e-3, 0},
    {"L", "m3", 1e-3, 0},
    {"lbf", "N", 4.4482216152605, 0},
    {"bar", "Pa", 1e5, 0},
    {"mbar", "Pa", 1e2, 0},
    {"psi", "Pa", 6894.757293168361, 0},
    {"kPa", "Pa", 1e3, 0},
    {"MPa", "Pa", 1e6, 0},
    {"GPa", "Pa", 1e9, 0},
    {"kW", "W", 1e3, 0},
    {"kJ", "J", 1e3, 0},
    {"mA", "A", 1e-3, 0},
    {"rpm", "rad/s", 1.0 / 30, 1},
    {"Nm", "N.m", 1, 0},
    {"kgm", "kg.m", 1, 0},
    {"radian", "rad", 1, 0},
    {"radians", "rad", 1, 0},
    {"sec", "s", 1, 0},
    {"second", "s", 1, 0},
    {"seconds", "s", 1, 0},
    {"meter", "m", 1, 0},
    {"meters", "m", 1, 0},
    {"metre", "m", 1, 0},
    {"metres", "m", 1, 0},
    {"kilogram", "kg", 1, 0},
    {"kilograms", "kg", 1, 0},
    {"Kg", "kg", 1, 0},
    {"KG", "kg", 1, 0},
    {"newton", "N", 1, 0},
    {"Newton", "N", 1, 0},
    {"hz", "Hz", 1, 0},
    {"HZ", "Hz", 1, 0},
    {"ohm", "Ohm", 1, 0},
};

/* Returns the length of the unit name at the start of a text: letters, "%" or the degree sign. */
static size_t length_of_name(const char *text) {
  if (*text == '%') return 1;
  size_t length = strncmp(text, "\xc2\xb0", 2) == 0 ? 2 : 0;
  while (isalpha((unsigned char)text[length])) length++;
  return length;
}

static const struct OtherUnit *find(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (strlen(others[i].name) == length && strncmp(others[i].name, name, length) == 0) return &others[i];
  return NULL;
}

/*
 * The result of a translation: 1 of the unit is factor * pi^pi_power of the SI unit. has_other: some unit in the text
 * is not an SI unit. is_wrong: the text is not a unit.
 */
struct Translation {
  bool has_other, is_wrong;
  double factor;
  int pi_power;
};

/* Writes a unit with SI names; exponents, points and slashes are copied. */
static struct Translation translate(const char *text, FILE *file) {
  struct Translation result = {.factor = 1};
  double side = 1; /* -1 after the slash */
  while (*text != '\0') {
    size_t length = length_of_name(text);
    if (length == 0) {
      if (*text == '/') side = -1;
      fputc(*text++, file);
      continue;
    }
    const struct OtherUnit *other = find(text, length);
    fprintf(file, "%.*s", other != NULL ? (int)strlen(other->si) : (int)length, other != NULL ? other->si : text);
    text += length;
    if (other == NULL) continue;
    const char *behind = text;
    double exponent = unit_exponent(&behind);
    bool is_pi_whole = other->pi_power == 0 || exponent == floor(exponent);
    result.has_other = true;
    result.is_wrong |= fabs(exponent) > 20 || !is_pi_whole || (behind > text && strpbrk(other->si, "./123") != NULL);
    if (result.is_wrong) break;
    result.factor *= pow(other->factor, side * exponent);
    result.pi_power += (int)(side * exponent) * other->pi_power;
  }
  return result;
}

/*
 * Writes a number with at most this number of digits, or as a power of ten; false if that differs by more than 1e-12.
 */
static bool write_number(char text[32], double number, int digits) {
  double exponent = round(log10(number));
  bool is_power = exponent != 0 && fabs(number * pow(10, -exponent) - 1) < 1e-12;
  if (is_power) snprintf(text, 32, "1e%.0f", exponent);
  else snprintf(text, 32, "%.*g", digits, number);
  return fabs(strtod(text, NULL) / number - 1) < 1e-12;
}

/* Returns a text such as "1e-2", "1/3.6", "pi/180" or "180/pi"; NULL if the factor is not a normal number. */
static char *factor_text(double factor, int pi_power) {
  char number[32], pi[32] = "pi";
  if (!isnormal(factor)) return NULL;
  bool is_above = write_number(number, factor, 8), is_below = !is_above && write_number(number, 1 / factor, 8);
  if (!is_above && !is_below) is_above = write_number(number, factor, 16);
  if (abs(pi_power) > 1) snprintf(pi, sizeof pi, "pi^%d", abs(pi_power));
  if (pi_power == 0) return format_text("%s%s", is_above ? "" : "1/", number);
  if (pi_power > 0) return format_text("%s%c%s", pi, is_above ? '*' : '/', number);
  return is_above ? format_text("%s/%s", number, pi) : format_text("1/(%s*%s)", number, pi);
}

/* Returns the unit with SI names; *translation has its factor. */
static char *translation_of(const char *text, struct Translation *translation) {
  struct TextStream stream;
  *translation = translate(text, open_text(&stream));
  return close_text(&stream);
}

static bool is_celsius(const char *text) {
  static const char sign[] = {'\xc2', '\xb0', 'C', '\0'};
  return strcmp(text, "degC") == 0 || strcmp(text, sign) == 0;
}

bool display_unit_parse(const char *text, struct Dimension *dimension, struct UnitScale *scale) {
  const char *problem;
  if (is_celsius(text)) {
    *scale = (struct UnitScale){.factor = 1, .offset = CELSIUS_ZERO};
    return unit_parse("K", dimension, &problem);
  }
  struct Translation translation;
  char *si = translation_of(text, &translation);
  bool is_known = translation.has_other && !translation.is_wrong && unit_parse(si, dimension, &problem);
  *scale = (struct UnitScale){.factor = translation.factor * pow(acos(-1.0), translation.pi_power)};
  return is_known && isnormal(scale->factor);
}

char *unit_remedy(const char *text) {
  if (is_celsius(text)) return format_text("expected K, and the value plus %g", CELSIUS_ZERO);
  struct Translation translation;
  char *si = translation_of(text, &translation);
  struct Dimension dimension;
  const char *problem;
  bool is_known = translation.has_other && !translation.is_wrong && unit_parse(si, &dimension, &problem);
  char *factor = is_known ? factor_text(translation.factor, translation.pi_power) : NULL;
  if (is_known && translation.factor == 1 && translation.pi_power == 0)
    return format_text("expected %s%s", si,
                       strchr(text, '.') == NULL && strchr(si, '.') != NULL ? ", with a point between units" : "");
  return factor != NULL ? format_text("expected %s, and the value times %s", si, factor) : NULL;
}
