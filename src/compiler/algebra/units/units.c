#include "algebra/units/units.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

const char *const base_unit_names[BASE_UNIT_COUNT] = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};
const struct Dimension dimension_unknown = {.known = false};
const struct Dimension dimension_one = {.known = true};

static const struct {
  const char *name;
  double exponent[BASE_UNIT_COUNT];
} table[] = {
    {"1", {0}},
    {"kg", {[KILOGRAM] = 1}},
    {"m", {[METRE] = 1}},
    {"s", {[SECOND] = 1}},
    {"A", {[AMPERE] = 1}},
    {"K", {[KELVIN] = 1}},
    {"mol", {[MOLE] = 1}},
    {"cd", {[CANDELA] = 1}},
    {"rad", {[RADIAN] = 1}},
    {"Hz", {[SECOND] = -1}},
    {"N", {[KILOGRAM] = 1, [METRE] = 1, [SECOND] = -2}},
    {"Pa", {[KILOGRAM] = 1, [METRE] = -1, [SECOND] = -2}},
    {"J", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -2}},
    {"W", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -3}},
    {"C", {[AMPERE] = 1, [SECOND] = 1}},
    {"V", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -3, [AMPERE] = -1}},
    {"F", {[KILOGRAM] = -1, [METRE] = -2, [SECOND] = 4, [AMPERE] = 2}},
    {"Ohm", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -3, [AMPERE] = -2}},
    {"S", {[KILOGRAM] = -1, [METRE] = -2, [SECOND] = 3, [AMPERE] = 2}},
    {"Wb", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -2, [AMPERE] = -1}},
    {"T", {[KILOGRAM] = 1, [SECOND] = -2, [AMPERE] = -1}},
    {"H", {[KILOGRAM] = 1, [METRE] = 2, [SECOND] = -2, [AMPERE] = -2}},
};

struct Dimension dimension_multiply(struct Dimension first, struct Dimension second, double power) {
  if (!first.known || !second.known) return dimension_unknown;
  for (int i = 0; i < BASE_UNIT_COUNT; i++) {
    double exponent = first.exponent[i] + power * second.exponent[i];
    first.exponent[i] = fabs(exponent - round(exponent)) < 1e-9 ? round(exponent) : exponent; /* thirds add up to 1 */
  }
  return first;
}

bool dimension_agrees(struct Dimension first, struct Dimension second) {
  if (!first.known || !second.known) return true;
  for (int i = 0; i < RADIAN; i++)
    if (fabs(first.exponent[i] - second.exponent[i]) > 1e-9) return false;
  return true;
}

const char *unit_hint(struct Dimension dimension) {
  for (int i = 0; i < BASE_UNIT_COUNT; i++)
    if (!dimension.known || dimension.exponent[i] != 0.0) return "";
  return "; multiply terms of the unit 1 by a <constant> or <parameter> that has a unit";
}

bool dimension_is_whole(struct Dimension dimension) {
  for (int i = 0; i < BASE_UNIT_COUNT; i++)
    if (dimension.exponent[i] != round(dimension.exponent[i])) return false;
  return dimension.known;
}

double unit_exponent(const char **text) {
  const char *next = *text + (**text == '-');
  if (!isdigit((unsigned char)*next)) return 1.0;
  while (isdigit((unsigned char)*next)) next++;
  if (*next == '.' && isdigit((unsigned char)next[1]))
    for (next++; isdigit((unsigned char)*next);) next++;
  double exponent = strtod(*text, NULL); /* reads no further: no unit begins with a digit, x or e */
  *text = next;
  return exponent;
}

/* The reading position in a unit, and the first error; NULL for none. */
struct UnitReader {
  const char *next;
  const char *problem;
};

/* Returns the remedy for a text without a unit name at its start. */
static const char *problem_of_name(const char *text) {
  if (*text == '\0' || strcmp(text, "-") == 0) return "expected 1 for a pure number, or no unit=\"...\"";
  if (*text == '[') return "expected it without brackets";
  if (strncmp(text, "sqrt(", 5) == 0) return "expected a decimal exponent for a root, as in Pa0.5 for sqrt(Pa)";
  return "expected coherent SI units such as kg, m, s, rad, N, J, W, Hz, joined by '.' and '/', "
         "for example kg.m2/s2 or N/(m.s)";
}

/* Returns the remedy for a text after a complete unit. */
static const char *problem_of_rest(const char *text) {
  if (*text == '^' || strncmp(text, "**", 2) == 0 || strncmp(text, "\xc2\xb2", 2) == 0 ||
      strncmp(text, "\xc2\xb3", 2) == 0)
    return "expected exponents as plain digits, as in m2 or s-1";
  if (*text == '*' || *text == ' ' || strncmp(text, "\xc2\xb7", 2) == 0)
    return "expected a point between units, as in N.m";
  return "expected the end of the unit; write one '/' with '(...)' after it for several units below it";
}

static struct Dimension read_factor(struct UnitReader *reader) {
  size_t length = 0;
  while (isalpha((unsigned char)reader->next[length])) length++;
  if (length == 0 && *reader->next == '1') length = 1;
  for (size_t i = 0; length > 0 && i < sizeof table / sizeof *table; i++) {
    if (strlen(table[i].name) != length || strncmp(table[i].name, reader->next, length) != 0) continue;
    reader->next += length;
    struct Dimension unit = dimension_one;
    memcpy(unit.exponent, table[i].exponent, sizeof unit.exponent);
    double exponent = unit_exponent(&reader->next);
    if (fabs(exponent) <= 20) return dimension_multiply(dimension_one, unit, exponent);
    reader->problem = "an exponent is out of range; expected one from -20 to 20";
    return dimension_unknown;
  }
  if (reader->problem == NULL) reader->problem = problem_of_name(reader->next);
  return dimension_unknown;
}

static struct Dimension read_product(struct UnitReader *reader) {
  struct Dimension product = read_factor(reader);
  while (*reader->next == '.' && reader->problem == NULL) {
    reader->next++;
    product = dimension_multiply(product, read_factor(reader), 1.0);
  }
  return product;
}

bool unit_parse(const char *text, struct Dimension *dimension, const char **problem) {
  struct UnitReader reader = {.next = text};
  *dimension = read_product(&reader);
  if (*reader.next == '/' && reader.problem == NULL) {
    reader.next++;
    bool parentheses = *reader.next == '(';
    if (parentheses) reader.next++;
    struct Dimension below = parentheses ? read_product(&reader) : read_factor(&reader);
    *dimension = dimension_multiply(*dimension, below, -1.0);
    if (parentheses && *reader.next++ != ')' && reader.problem == NULL) reader.problem = "expected ')'";
  }
  if (reader.problem == NULL && *reader.next != '\0') reader.problem = problem_of_rest(reader.next);
  if (reader.problem != NULL) *dimension = dimension_unknown;
  *problem = reader.problem;
  return reader.problem == NULL;
}

struct Dimension unit_of(const char *text) {
  struct Dimension dimension;
  const char *problem;
  unit_parse(text, &dimension, &problem);
  return dimension;
}

static void append_powers(FILE *file, struct Dimension dimension, int sign, const char *separator) {
  for (int i = 0; i < BASE_UNIT_COUNT; i++) {
    double exponent = dimension.exponent[i] * sign;
    if (exponent <= 0) continue;
    fprintf(file, "%s%s", separator, base_unit_names[i]);
    if (exponent != 1) fprintf(file, "%g", exponent);
    separator = ".";
  }
}

char *unit_text(struct Dimension dimension) {
  int above = 0, below = 0;
  for (int i = 0; i < BASE_UNIT_COUNT; i++) {
    above += dimension.exponent[i] > 0;
    below += dimension.exponent[i] < 0;
  }
  struct TextStream text;
  FILE *file = open_text(&text);
  if (above == 0) fputs("1", file);
  append_powers(file, dimension, 1, "");
  if (below > 0) fputs(below > 1 ? "/(" : "/", file);
  append_powers(file, dimension, -1, "");
  if (below > 1) fputs(")", file);
  return close_text(&text);
}
