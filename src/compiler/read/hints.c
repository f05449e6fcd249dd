#include "read/hints.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

struct Hint {
  const char *written, *hint;
};

static const struct Hint of_text[] = {
    {"**", "; write ^ for a power"},
    {"*", "; write one * for a product and ^ for a power"},
    {"&", "; there are no conditions: min, max, abs and sign make pieces"},
    {"<", "; there are no conditions: min, max, abs and sign make pieces"},
    {">", "; there are no conditions: min, max, abs and sign make pieces"},
    {"=", "; write the value alone, without a name and ="},
    {"[", "; write round parentheses, and [...] only for the index of a name"},
    {"{", "; write round parentheses"},
    {"|", "; write abs(...) for a magnitude"},
    {"'", "; write der(...) for a time derivative"},
    {";", "; write no ; at the end"},
    {"\xc2\xb7", "; write * for a product"},
    {"\xc3\x97", "; write * for a product"},
    {"\xe2\x88\x92", "; write - for a minus sign"},
    {"\xc2\xb2", "; write ^2 for a square"},
};

static const struct Hint of_functions[] = {
    {"ln", "; write log for the natural logarithm"},
    {"log10", "; write log(x)/log(10)"},
    {"log2", "; write log(x)/log(2)"},
    {"if", "; there are no conditions: min, max, abs and sign make pieces"},
    {"arcsin", "; write asin"},
    {"arccos", "; write acos"},
    {"arctan", "; write atan"},
    {"arctan2", "; write atan2"},
    {"fabs", "; write abs"},
    {"sgn", "; write sign"},
    {"diff", "; write der for a time derivative"},
    {"cbrt", "; write sign(x)*abs(x)^(1/3)"},
};

const char *hint_for_text(const char *begin, const char *next) {
  bool after_digit = next > begin && isdigit((unsigned char)next[-1]);
  if (*next == ',' && after_digit && isdigit((unsigned char)next[1])) return "; write a point in numbers, as in 9.81";
  if (next > begin && isalpha((unsigned char)*next) && next[-1] == ' ')
    return "; write * for a product, and units in unit=\"...\"";
  for (size_t i = 0; i < sizeof of_text / sizeof *of_text; i++)
    if (strncmp(next, of_text[i].written, strlen(of_text[i].written)) == 0) return of_text[i].hint;
  return "";
}

const char *hint_for_function(const char *name) {
  for (size_t i = 0; i < sizeof of_functions / sizeof *of_functions; i++)
    if (strcmp(name, of_functions[i].written) == 0) return of_functions[i].hint;
  return "";
}

const char *hint_for_kind(enum SymbolKind kind) {
  switch (kind) {
  case INPUT:
    return "; expected it in a <force>, or what it moves as a <coordinate> that a stiff spring and damper draw there";
  case VELOCITY: return "; expected positions of coordinates and time, from which velocities follow";
  case ACCELERATION: return "; expected them in an <output> alone: inertia belongs in masses and <kinetic>";
  case COORDINATE:
  case TIME: return "; expected numbers and parameters";
  case PARAMETER: return "; expected numbers and constants";
  default: return "";
  }
}
