#include "display/products.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/*
 * A coefficient with more characters than DIGIT_LIMIT is shown as a ratio of whole numbers if there is one. One of both
 * is at most RATIO_LIMIT, the other at most WHOLE_LIMIT.
 */
enum { RATIO_LIMIT = 45, WHOLE_LIMIT = 10000000, DIGIT_LIMIT = 8 };

/* True if one of the characters stands outside of parentheses. */
static bool has_outside(const char *text, const char *characters) {
  int depth = 0;
  for (; *text != '\0'; text++) {
    depth += (*text == '(' || *text == '[') - (*text == ')' || *text == ']');
    if (depth == 0 && strchr(characters, *text) != NULL) return true;
  }
  return false;
}

char *fenced_base(const char *text) {
  return has_outside(text, "+-*/^") ? format_text("(%s)", text) : copy_text(text);
}

char *fenced_factor(const char *text) {
  return has_outside(text, "+-") ? format_text("(%s)", text) : copy_text(text);
}

enum FactorRank factor_rank(const struct Atoms *atoms, Node atom) {
  static const enum FactorRank of_symbol[SYMBOL_KIND_COUNT] = {
      [PARAMETER] = RANK_PARAMETER,   [MODE] = RANK_MODE,
      [INPUT] = RANK_INPUT,           [TIME] = RANK_TIME,
      [COORDINATE] = RANK_COORDINATE, [STATE] = RANK_STATE,
      [VELOCITY] = RANK_VELOCITY,     [ACCELERATION] = RANK_ACCELERATION};
  const struct Graph *graph = atoms->graph;
  const struct Vertex *vertex = &graph->vertices[atom];
  bool is_of_parameters = (vertex->kinds & ~(1u << PARAMETER)) == 0;
  if (vertex->operation == SYMBOL) return of_symbol[graph_symbol_of(graph, atom)->kind];
  if (displayed_name(atoms, atom) != NULL) return is_of_parameters ? RANK_PARAMETER : RANK_NAMED;
  bool is_sum = vertex->operation == ADD || vertex->operation == MULTIPLY;
  if (!is_sum) return RANK_FUNCTION;
  return is_of_parameters ? RANK_PARAMETER_SUM : RANK_SUM;
}

static char *power_text(const char *text, double exponent) {
  if (exponent == 0.5) return format_text("sqrt(%s)", text);
  if (exponent == 1.0) return has_outside(text, "+-/") ? format_text("(%s)", text) : copy_text(text);
  return format_text("%s^%.15g", fenced_base(text), exponent);
}

/* A list of factors, joined by *. */
struct FactorList {
  char *text; /* NULL if empty */
  int count;
};

/* Appends a factor, and releases its text. */
static void append_factor(struct FactorList *list, char *factor) {
  char *text = list->text != NULL ? format_text("%s*%s", list->text, factor) : copy_text(factor);
  release(list->text);
  release(factor);
  list->text = text;
  list->count++;
}

/* True for a whole number but for rounding. */
static bool is_nearly_whole(double number) {
  double whole = round(number);
  return whole >= 1.0 && whole <= WHOLE_LIMIT && fabs(number - whole) <= 1e-14 * whole;
}

/* Splits a number into a numerator and a denominator, 1 if there is none. */
static void split_number(double number, double *above, double *below) {
  *above = number;
  *below = 1.0;
  char text[32];
  bool is_long = snprintf(text, sizeof text, "%.15g", number) > DIGIT_LIMIT;
  for (int i = 1; i <= (is_long ? RATIO_LIMIT : 1); i++) {
    double whole = number * i, inverse = i / number;
    bool is_ratio = number >= 1.0 ? i > 1 && is_nearly_whole(whole)
                    : is_long     ? is_nearly_whole(inverse)
                                  : inverse == floor(inverse);
    if (!is_ratio) continue;
    *above = number < 1.0 ? i : round(whole);
    *below = number < 1.0 ? round(inverse) : i;
    return;
  }
}

/* True if atom a stands before b in a product. */
static bool is_before(const struct Atoms *atoms, int a, int b) {
  enum FactorRank left = factor_rank(atoms, atoms->nodes[a]), right = factor_rank(atoms, atoms->nodes[b]);
  if (left != right) return left < right;
  bool functions = left == RANK_FUNCTION;
  enum Operation first = atoms->graph->vertices[atoms->nodes[a]].operation,
                 second = atoms->graph->vertices[atoms->nodes[b]].operation;
  if (functions && first != second) return first < second;
  return atoms->nodes[a] < atoms->nodes[b];
}

char *product_text(const struct Atoms *atoms, double number, const struct Term *term, const char *const *texts,
                   const char *first) {
  struct FactorList above = {NULL, 0}, below = {NULL, 0};
  double whole, divisor;
  int order[ATOM_ROOM], count = 0;
  split_number(number, &whole, &divisor);
  if (whole != 1.0) append_factor(&above, format_text("%.15g", whole));
  if (divisor != 1.0) append_factor(&below, format_text("%.15g", divisor));
  if (first != NULL) append_factor(&above, fenced_factor(first));
  for (int k = 0; k < atoms->count; k++) {
    if (term->exponents[k] == 0.0) continue;
    int i = count++;
    for (; i > 0 && is_before(atoms, k, order[i - 1]); i--) order[i] = order[i - 1];
    order[i] = k;
  }
  for (int i = 0; i < count; i++) {
    double exponent = term->exponents[order[i]];
    append_factor(exponent > 0.0 ? &above : &below, power_text(texts[order[i]], fabs(exponent)));
  }
  const char *numerator = above.text != NULL ? above.text : "1";
  if (below.text == NULL) return copy_text(numerator);
  bool single = below.count == 1 && !has_outside(below.text, "*/");
  return format_text(single ? "%s/%s" : "%s/(%s)", numerator, below.text);
}
