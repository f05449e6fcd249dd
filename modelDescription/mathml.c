#include "mathml.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define MATH "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" displaystyle=\"true\">"

static const char between_terms[] = "</math> " MATH;

/* A part of a formula; one that was in parentheses needs them unless a fraction bar or a raised place holds it together. */
struct Piece {
  char *math;
  bool fenced;
};

/* Where the text is read. The functions below go on after what they read, and set wrong where they cannot. */
struct Text {
  const char *at;
  bool wrong;
};

static struct Piece sum(struct Text *text, const char *separator);

static void skip_spaces(struct Text *text) {
  text->at += strspn(text->at, " ");
}

static bool take(struct Text *text, const char *word) {
  skip_spaces(text);
  bool there = strncmp(text->at, word, strlen(word)) == 0;
  if (there) text->at += strlen(word);
  return there;
}

/* Writes strings into a format, and frees them. */
static char *around(const char *format, char *first, char *second) {
  return second != NULL ? format_text(format, first, second) : format_text(format, first);
}

static char *fence(struct Piece piece) {
  return piece.fenced ? around("<mrow><mo>(</mo>%s<mo>)</mo></mrow>", piece.math, NULL) : piece.math;
}

/* A Greek letter by its name. */
static const char *symbol_of(const char *name) {
  static const char *const letters[][2] = {
      {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"},  {"delta", "δ"}, {"epsilon", "ε"}, {"zeta", "ζ"}, {"eta", "η"},
      {"theta", "θ"}, {"kappa", "κ"}, {"lambda", "λ"}, {"mu", "μ"},    {"nu", "ν"},      {"xi", "ξ"},   {"pi", "π"},
      {"rho", "ρ"},   {"sigma", "σ"}, {"tau", "τ"},    {"phi", "φ"},   {"chi", "χ"},     {"psi", "ψ"},  {"omega", "ω"},
      {"Delta", "Δ"}, {"Theta", "Θ"}, {"Phi", "Φ"},    {"Psi", "Ψ"},   {"Omega", "Ω"}};
  for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
    if (strcmp(letters[i][0], name) == 0) return letters[i][1];
  return name;
}

/* theta[2] and theta2 get an index; bob.x stays as it is. */
static char *variable(const char *name) {
  size_t length = strlen(name), base = strcspn(name, "[");
  bool plain = strchr(name, '.') == NULL;
  if (base == length)
    while (base > 1 && isdigit((unsigned char)name[base - 1])) base--;
  if (!plain || base == length) return format_text("<mi>%s</mi>", symbol_of(name));
  char *letter = format_text("%.*s", (int)base, name);
  bool bracket = name[base] == '[' && name[length - 1] == ']';
  return format_text("<msub><mi>%s</mi><mn>%.*s</mn></msub>", symbol_of(letter),
                     (int)(length - base) - (bracket ? 2 : 0), name + base + (bracket ? 1 : 0));
}

static char *application(const char *function, char *arguments) {
  if (strcmp(function, "sqrt") == 0) return around("<msqrt>%s</msqrt>", arguments, NULL);
  if (strcmp(function, "abs") == 0) return around("<mrow><mo>|</mo>%s<mo>|</mo></mrow>", arguments, NULL);
  if (strcmp(function, "der") == 0) return around("<mover accent=\"true\">%s<mo>˙</mo></mover>", arguments, NULL);
  return around("<mrow><mi>%s</mi><mo>&#x2061;</mo><mrow><mo>(</mo>%s<mo>)</mo></mrow></mrow>", copy_text(function),
                arguments);
}

static char *name_or_function(struct Text *text) {
  size_t length = 0;
  while (isalnum((unsigned char)text->at[length]) || strchr("_.[]", text->at[length] == '\0' ? ' ' : text->at[length]))
    length++;
  while (length > 3 && memcmp(text->at + length - 3, "...", 3) == 0) length -= 3; /* a formula that was cut off */
  char *name = format_text("%.*s", (int)length, text->at), *math;
  text->at += length;
  if (take(text, "(")) {
    char *arguments = sum(text, "").math;
    if (take(text, ">")) arguments = around("%s<mo>&gt;</mo>%s", arguments, sum(text, "").math);
    while (take(text, ",")) arguments = around("%s<mo>,</mo>%s", arguments, sum(text, "").math);
    text->wrong |= !take(text, ")");
    math = application(name, arguments);
  } else math = variable(name);
  return math;
}

static struct Piece primary(struct Text *text) {
  skip_spaces(text);
  if (take(text, "...")) return (struct Piece){copy_text("<mo>…</mo>"), false};
  if (isdigit((unsigned char)*text->at)) {
    char *end;
    strtod(text->at, &end);
    struct Piece number = {format_text("<mn>%.*s</mn>", (int)(end - text->at), text->at), false};
    text->at = end;
    return number;
  }
  if (isalpha((unsigned char)*text->at) || *text->at == '_') return (struct Piece){name_or_function(text), false};
  text->wrong |= !take(text, "(");
  if (text->wrong) return (struct Piece){copy_text(""), false};
  struct Piece inside = {sum(text, "").math, true};
  text->wrong |= !take(text, ")");
  return inside;
}

static struct Piece power(struct Text *text) {
  struct Piece base = primary(text);
  if (!take(text, "^")) return base;
  const char *sign = take(text, "-") ? "<mo>−</mo>" : "";
  char *exponent = format_text("%s", sign);
  exponent = around("%s%s", exponent, primary(text).math);
  return (struct Piece){around("<msup><mrow>%s</mrow><mrow>%s</mrow></msup>", fence(base), exponent), false};
}

static struct Piece product(struct Text *text) {
  struct Piece whole = power(text);
  while (!text->wrong) {
    if (take(text, "*")) whole.math = around("%s<mo>⋅</mo>%s", fence(whole), fence(power(text)));
    else if (take(text, "/"))
      whole.math = around("<mfrac><mrow>%s</mrow><mrow>%s</mrow></mfrac>", whole.math, power(text).math);
    else break;
    whole.fenced = false;
  }
  return whole;
}

/* The separator stands before the sign of each further term. */
static struct Piece sum(struct Text *text, const char *separator) {
  bool negative = take(text, "-");
  struct Piece whole = product(text);
  if (negative) whole = (struct Piece){around("<mo>−</mo>%s", fence(whole), NULL), false};
  while (!text->wrong) {
    skip_spaces(text);
    const char *sign = take(text, "+")                    ? "<mo>+</mo>"
                       : take(text, "-")                  ? "<mo>−</mo>"
                       : strncmp(text->at, "...", 3) == 0 ? ""
                                                          : NULL;
    if (sign == NULL) break;
    char *before = around("%s%s", fence(whole), format_text("%s%s", separator, sign));
    whole = (struct Piece){around("%s%s", before, fence(product(text))), false};
  }
  return whole;
}

/* Nobody reads longer ones. */
enum { LENGTH_LIMIT = 3000 };

char *mathml_of_equation(const char *equation) {
  if (strlen(equation) > LENGTH_LIMIT) return NULL;
  struct Text text = {.at = equation};
  char *left = fence(sum(&text, "")), *right = NULL;
  text.wrong |= !take(&text, "=");
  right = text.wrong ? copy_text("") : fence(sum(&text, between_terms));
  skip_spaces(&text);
  if (!text.wrong && *text.at == '\0') return around(MATH "%s</math> " MATH "<mo>=</mo>%s</math>", left, right);
  return NULL;
}
