/*
 * A recursive descent parser for the grammar
 *
 *     sum = ["-"] product {("+" | "-") product}      power = primary ["^" ["-"] primary]
 *     product = power {("*" | "/") power}            argument = sum [">" sum]
 *     primary = number | name ["(" argument {"," argument} ")"] | "(" sum ")" | "..."
 *
 * where "..." stands for omitted terms. Reads each character once; the recursion is as deep as the parentheses.
 */
#include "formula_tree.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "glyphs.h"

/* The position in the text. Parsing functions advance it, and set wrong on a syntax error. */
struct Text {
  const char *at;
  bool wrong;
};

static struct Formula *read_sum(struct Text *text);

static struct Formula *leaf(enum FormulaKind kind, char *word) {
  struct Formula *formula = allocate(1, sizeof *formula);
  *formula = (struct Formula){.kind = kind, .word = word};
  return formula;
}

static void append(struct Formula *formula, struct Formula *part) {
  formula->parts = make_room(formula->parts, formula->count, sizeof(struct Formula *));
  formula->parts[formula->count++] = part;
}

static struct Formula *pair(enum FormulaKind kind, struct Formula *first, struct Formula *second) {
  struct Formula *formula = leaf(kind, NULL);
  append(formula, first);
  append(formula, second);
  return formula;
}

static void skip_spaces(struct Text *text) {
  text->at += strspn(text->at, " ");
}

static bool take(struct Text *text, const char *word) {
  skip_spaces(text);
  bool there = strncmp(text->at, word, strlen(word)) == 0;
  if (there) text->at += strlen(word);
  return there;
}

/* Parses an argument, which is a condition in if(a > 0, b, c). */
static struct Formula *read_argument(struct Text *text) {
  struct Formula *argument = read_sum(text);
  return take(text, ">") ? pair(CONDITION, argument, read_sum(text)) : argument;
}

static struct Formula *read_word(struct Text *text) {
  size_t length = 0;
  while (isalnum((unsigned char)text->at[length]) || strchr("_.[]", text->at[length] == '\0' ? ' ' : text->at[length]))
    length++;
  while (length > 3 && memcmp(text->at + length - 3, "...", 3) == 0) length -= 3; /* the dots of an abridged formula */
  struct Formula *formula = leaf(NAME, format_text("%.*s", (int)length, text->at));
  text->at += length;
  if (!take(text, "(")) return formula;
  formula->kind = APPLICATION;
  do append(formula, read_argument(text));
  while (take(text, ","));
  text->wrong |= !take(text, ")");
  return formula;
}

static struct Formula *read_primary(struct Text *text) {
  skip_spaces(text);
  if (take(text, "...")) return leaf(ELLIPSIS, NULL);
  if (isdigit((unsigned char)*text->at)) {
    char *end;
    strtod(text->at, &end);
    struct Formula *number = leaf(NUMBER, format_text("%.*s", (int)(end - text->at), text->at));
    text->at = end;
    return number;
  }
  if (isalpha((unsigned char)*text->at) || *text->at == '_') return read_word(text);
  text->wrong |= !take(text, "(");
  if (text->wrong) return leaf(ELLIPSIS, NULL);
  struct Formula *inside = read_sum(text);
  text->wrong |= !take(text, ")");
  return inside;
}

static struct Formula *negative(struct Formula *formula) {
  struct Formula *whole = leaf(NEGATIVE, NULL);
  append(whole, formula);
  return whole;
}

static struct Formula *read_power(struct Text *text) {
  struct Formula *base = read_primary(text);
  if (!take(text, "^")) return base;
  bool is_negative = take(text, "-");
  struct Formula *exponent = read_primary(text);
  return pair(RAISED, base, is_negative ? negative(exponent) : exponent);
}

/* Appends a part to a sum or product, or creates one. */
static struct Formula *join(enum FormulaKind kind, struct Formula *whole, struct Formula *part) {
  if (whole->kind != kind) return pair(kind, whole, part);
  append(whole, part);
  return whole;
}

static struct Formula *multiply(struct Formula *whole, struct Formula *factor) {
  if (factor->kind != PRODUCT) return join(PRODUCT, whole, factor);
  for (size_t i = 0; i < factor->count; i++) whole = join(PRODUCT, whole, factor->parts[i]);
  return whole;
}

static struct Formula *read_product(struct Text *text) {
  struct Formula *whole = read_power(text);
  while (!text->wrong) {
    if (take(text, "*")) whole = multiply(whole, read_power(text));
    else if (take(text, "/")) whole = pair(FRACTION, whole, read_power(text));
    else break;
  }
  return whole;
}

static struct Formula *read_sum(struct Text *text) {
  bool is_negative = take(text, "-");
  struct Formula *whole = read_product(text);
  if (is_negative) whole = negative(whole);
  while (!text->wrong) {
    skip_spaces(text);
    bool plus = take(text, "+"), minus = !plus && take(text, "-");
    if (!plus && !minus && strncmp(text->at, "...", 3) != 0) break;
    struct Formula *term = read_product(text);
    whole = join(SUM, whole, minus ? negative(term) : term);
  }
  return whole;
}

bool is_choice(const struct Formula *formula) {
  return formula->kind == APPLICATION && formula->count == 3 && strcmp(formula->word, "if") == 0;
}

/* Estimates the widths of a formula and its parts. Signs with their spaces, and parentheses, count as letters. */
static void measure(struct Formula *formula) {
  double sum = 0.0, largest = 0.0;
  formula->is_tall = formula->kind == FRACTION || is_choice(formula);
  for (size_t i = 0; i < formula->count; i++) {
    measure(formula->parts[i]);
    formula->is_tall |= formula->parts[i]->is_tall;
    sum += formula->parts[i]->width;
    largest = fmax(largest, formula->parts[i]->width);
  }
  double count = (double)formula->count;
  switch (formula->kind) {
  case NUMBER: formula->width = (double)strlen(formula->word); break;
  case NAME: formula->width = glyphs_width(formula->word); break;
  case ELLIPSIS: formula->width = 2.0; break;
  case APPLICATION:
    formula->width = (double)strlen(formula->word) + 2.0 + sum + count - 1.0;
    if (is_choice(formula))
      formula->width = sum - formula->parts[1]->width - formula->parts[2]->width + 4.0 +
                       fmax(formula->parts[1]->width, formula->parts[2]->width);
    break;
  case CONDITION: formula->width = sum + 3.0; break;
  case SUM: formula->width = sum + 2.0 * (count - 1.0) + 2.0; break; /* with parentheses */
  case NEGATIVE: formula->width = sum + 1.0; break;
  case PRODUCT: formula->width = sum + 0.3 * (count - 1.0); break;
  case FRACTION: formula->width = largest + 0.5; break;
  case RAISED: formula->width = formula->parts[0]->width + 0.7 * formula->parts[1]->width + 1.0; break;
  }
}

bool formula_read(const char *equation, struct Formula *sides[2]) {
  struct Text text = {.at = equation};
  sides[0] = read_sum(&text);
  text.wrong |= !take(&text, "=");
  sides[1] = text.wrong ? NULL : read_sum(&text);
  skip_spaces(&text);
  bool right = !text.wrong && *text.at == '\0';
  for (int i = 0; i < 2 && right; i++) measure(sides[i]);
  return right;
}

struct Formula *formula_of_name(const char *name) {
  struct Text text = {.at = name};
  struct Formula *formula = read_word(&text);
  measure(formula);
  return formula;
}
