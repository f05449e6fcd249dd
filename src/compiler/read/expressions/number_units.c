#include "read/expressions/number_units.h"

#include <ctype.h>
#include <string.h>

#include "base/memory.h"
#include "names/definitions.h"

/* Returns the factor with more digits, which is more likely a measured quantity: 9.81 rather than 2. */
struct NumberFactor factor_of_product(struct NumberFactor first, struct NumberFactor second) {
  if (first.text == NULL) return second;
  return second.text != NULL && strlen(second.text) > strlen(first.text) ? second : first;
}

struct NumberFactor factor_raised(struct NumberFactor factor, double power) {
  return (struct NumberFactor){.text = power != 0.0 ? factor.text : NULL, .power = factor.power * power};
}

struct NumberFactor factor_of_sum(struct Quantity first, struct Quantity second) {
  if (first.literal) return second.factor;
  if (second.literal) return first.factor;
  return first.factor.text != NULL ? second.factor : first.factor;
}

/* Returns the unit that the number should have, without radians; "..." if exponents are fractional. */
static const char *missing_unit(struct Quantity quantity, struct Dimension expected) {
  struct Dimension ratio = dimension_multiply(expected, quantity.dimension, -1.0);
  struct Dimension unit = dimension_multiply(dimension_one, ratio, 1.0 / quantity.factor.power);
  unit.exponent[RADIAN] = 0.0;
  return dimension_is_whole(unit) ? unit_text(unit) : "...";
}

/* True if the problem is in the value of an input, such as a controller's. Of a file with many the first one counts. */
static bool is_of_input(const char *problem) {
  return strstr(problem, "value of <input>") != NULL || strstr(problem, "value of the input") != NULL;
}

bool number_may_have_unit(struct Scope *scope, long line, struct Quantity quantity, struct Dimension expected,
                          const char *problem) {
  const char *number = quantity.factor.text;
  if (number == NULL) return false;
  char *location = is_of_input(problem) ? format_text("%s:<input>", scope->diagnostics->file)
                                        : format_text("%s:%ld:%s", scope->diagnostics->file, line, number);
  if (definitions_are_waiting(scope->definitions) || names_find(scope->warned_numbers, location) != NULL) return true;
  names_set(scope->warned_numbers, location, location);
  const char *unit = missing_unit(quantity, expected);
  bool is_constant = isalpha((unsigned char)*number) || *number == '_';
  if (is_constant)
    report_warning(scope->diagnostics, line, "%s; '%s' is a number without a unit: if it has one, add unit=\"%s\"",
                   problem, number, unit);
  else
    report_warning(scope->diagnostics, line,
                   "%s; %s is a number without a unit: if it has one, write it as <constant name=\"...\" value=\"%s\" "
                   "unit=\"%s\"/>%s",
                   problem, number, number, unit,
                   is_of_input(problem) ? "; further values of inputs give no such warning" : "");
  return true;
}
