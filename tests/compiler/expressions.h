/* Expressions in x, y and z for the tests of the compiler. */
#ifndef EXPRESSIONS_H
#define EXPRESSIONS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "read/expressions/parser.h"
#include "names/words.h"
#include "algebra/formula.h"
#include "algebra/simplify.h"

struct Expressions {
  struct Diagnostics diagnostics;
  struct Graph *graph;
  struct Scope *scope;
  Node x, y, z;
};

static inline struct Expressions expressions_create(void) {
  struct Expressions e = {.diagnostics = {.file = "test"}, .graph = graph_create()};
  e.scope = scope_create(e.graph, NULL);
  define_language(e.scope);
  e.x = scope_symbol(e.scope, COORDINATE, 0, "x", dimension_unknown, 1);
  e.y = scope_symbol(e.scope, COORDINATE, 1, "y", dimension_unknown, 1);
  e.z = scope_symbol(e.scope, COORDINATE, 2, "z", dimension_unknown, 1);
  return e;
}

/* Parses an expression; errors are counted in e->diagnostics. */
static inline Node parse(struct Expressions *e, const char *text) {
  e->scope->diagnostics = &e->diagnostics;
  struct Location location = {.line = 1, .what = "the test", .kinds = 1u << COORDINATE};
  return parse_expression(e->scope, text, location).node;
}

static inline double value_at(const struct Expressions *e, Node node, double x, double y, double z) {
  const double symbols[] = {x, y, z};
  double *values = graph_evaluate(e->graph, symbols), value = values[node];
  return value;
}

/* Asserts the text that the expression prints as. */
static inline void assert_prints(struct Expressions *e, const char *text, const char *expected) {
  char *printed = expression_text(e->graph, parse(e, text));
  assert_string_equal(printed, expected);
}

#endif
