#include "read/context/value_texts.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/units/other_units.h"
#include "read/expressions/parser.h"
#include "names/words.h"

/* A value x in the unit is factor * x + offset in the coherent unit of its dimension. */
static bool scale_of(const char *unit, struct Dimension *dimension, struct UnitScale *scale) {
  const char *problem;
  *scale = (struct UnitScale){.factor = 1};
  return unit_parse(unit, dimension, &problem) || display_unit_parse(unit, dimension, scale);
}

/* Returns the unit after the number at the beginning of a text; NULL if either is missing. */
static const char *unit_after(const char *text, double *number) {
  char *end;
  *number = strtod(text, &end);
  if (end == text || strpbrk(text, "xX") == text + 1) return NULL;
  while (isspace((unsigned char)*end)) end++;
  return isalpha((unsigned char)*end) || *end == '%' || *end == '\xc2' ? end : NULL;
}

/* True if one unit counts cycles and the other radians: 1 Hz is 2 pi rad/s, which the dimensions do not show. */
static bool is_cycle_for_angle(const char *unit, struct Dimension own, struct Dimension expected) {
  return strstr(unit, "Hz") != NULL && own.exponent[RADIAN] != expected.exponent[RADIAN];
}

bool value_has_unit(const char *text) {
  double number;
  return unit_after(text, &number) != NULL;
}

bool value_of_option(const char *option, const char *text, const char *unit, struct Diagnostics *diagnostics,
                     double *value) {
  struct Diagnostics own = {.file = option};
  bool is_read = value_read(text, unit, &own, value);
  diagnostics->errors += own.errors;
  return is_read;
}

bool value_read(const char *text, const char *unit, struct Diagnostics *diagnostics, double *value) {
  struct Dimension own, expected;
  struct UnitScale from, to;
  double number;
  const char *after = unit_after(text, &number);
  if (after == NULL) {
    struct Scope *scope = scope_create(graph_create(), diagnostics);
    define_language(scope);
    return parse_number(scope, text, (struct Location){.what = "the value"}, value);
  }
  if (strcmp(after, unit) == 0) {
    *value = number;
    return isfinite(number);
  }
  if (!scale_of(after, &own, &from)) {
    report_error(diagnostics, 0, "the unit '%s' of '%s' is not known; expected a value in %s", after, text, unit);
    return false;
  }
  bool is_known = scale_of(unit, &expected, &to);
  if (!is_known || !dimension_agrees(own, expected) || is_cycle_for_angle(after, own, expected)) {
    report_error(diagnostics, 0, "'%s' is in %s; expected a value in %s", text, after, unit);
    return false;
  }
  *value = (number * from.factor + from.offset - to.offset) / to.factor;
  return true;
}

bool value_of_numbers(const char *text, double *value) {
  struct Diagnostics silent = {.errors = ERROR_LIMIT + 1};
  return !value_has_unit(text) && value_read(text, "1", &silent, value);
}
