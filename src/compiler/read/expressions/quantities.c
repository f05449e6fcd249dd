#include "read/expressions/quantities.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/functions.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/model.h"
#include "read/expressions/number_units.h"
#include "names/piecewise_functions.h"

static double value_at_start(const struct Scope *scope, Node node) {
  const struct Graph *graph = scope->graph;
  if (graph_is_constant(graph, node)) return graph_value(graph, node);
  double *symbols = start_values(scope->model), *values = allocate(graph->count, sizeof *values);
  cone_collect(graph->cone, graph, &node, 1);
  graph_evaluate_part(graph, graph->cone->nodes, graph->cone->count, symbols, values);
  double value = values[node];
  release(symbols);
  release(values);
  return value;
}

/* Requires a pure number as the argument of floor, ceil or round. */
static void require_countable(struct Parser *parser, struct Quantity value, const char *name) {
  if (!scope_units_agree(parser->scope, value.dimension, dimension_one) && !value.literal)
    FAIL(parser,
         "%s: unit mismatch: the argument of %s has the unit %s, expected 1; divide it by a step of this unit, as in "
         "step*%s(x/step)",
         parser->location.what, name, unit_text(value.dimension), name);
}

static void require_dimensionless(struct Parser *parser, struct Quantity value, const char *what) {
  if (scope_units_agree(parser->scope, value.dimension, dimension_one)) return;
  char *problem = format_text("%s: unit mismatch: %s has the unit %s, expected 1 or rad", parser->location.what, what,
                              unit_text(value.dimension));
  if (!number_may_have_unit(parser->scope, current_line(parser), value, dimension_one, problem))
    FAIL(parser, "%s", problem);
}

/*
 * Reports operands whose units disagree, by a warning if a numeric factor can explain it. Returns the unit to continue
 * with: that of a, or of b if the factor is in a.
 */
static struct Dimension corrected_dimension(struct Parser *parser, struct Quantity a, struct Quantity b,
                                            const char *where) {
  char *problem = format_text("%s: unit mismatch: %s and %s in one %s; expected the same unit", parser->location.what,
                              unit_text(a.dimension), unit_text(b.dimension), where);
  long line = current_line(parser);
  if (number_may_have_unit(parser->scope, line, b, a.dimension, problem)) return a.dimension;
  if (number_may_have_unit(parser->scope, line, a, b.dimension, problem)) return b.dimension;
  const char *hint = unit_hint(a.dimension);
  FAIL(parser, "%s%s", problem, *hint != '\0' ? hint : unit_hint(b.dimension));
  return a.dimension;
}

/* Returns the common unit of the operands of a sum, minimum or maximum, and reports disagreement. */
static struct Dimension common_dimension(struct Parser *parser, struct Quantity a, struct Quantity b,
                                         const char *where) {
  if (a.literal) return b.dimension;
  if (b.literal) return a.dimension;
  if (!scope_units_agree(parser->scope, a.dimension, b.dimension)) return corrected_dimension(parser, a, b, where);
  return a.dimension.known ? a.dimension : b.dimension;
}

/* Reports a constant that overflowed or is undefined. The flag was cleared at the beginning of the expression. */
static void require_finite(struct Parser *parser, const char *what) {
  if (parser->graph->not_finite)
    FAIL(parser, "%s: %s of numbers is not finite; expected numbers below 1e308", parser->location.what, what);
}

static struct Quantity sum_with(struct Parser *parser, struct Quantity a, struct Quantity b, Node node) {
  struct Quantity result = {.node = node,
                            .dimension = common_dimension(parser, a, b, "sum"),
                            .factor = factor_of_sum(a, b),
                            .literal = a.literal && b.literal};
  require_finite(parser, "a sum");
  return result;
}

struct Quantity quantity_add(struct Parser *parser, struct Quantity a, struct Quantity b) {
  return sum_with(parser, a, b, add(parser->graph, a.node, b.node));
}

struct Quantity quantity_subtract(struct Parser *parser, struct Quantity a, struct Quantity b) {
  return sum_with(parser, a, b, subtract(parser->graph, a.node, b.node));
}

struct Quantity quantity_multiply(struct Parser *parser, struct Quantity a, struct Quantity b) {
  struct Quantity result = {.node = multiply(parser->graph, a.node, b.node),
                            .dimension = dimension_multiply(a.dimension, b.dimension, 1.0),
                            .factor = factor_of_product(a.factor, b.factor),
                            .literal = a.literal && b.literal};
  require_finite(parser, "a product");
  return result;
}

struct Quantity quantity_divide(struct Parser *parser, struct Quantity a, struct Quantity b) {
  if (b.node == ZERO)
    FAIL(parser, "%s: a division by zero has no value; expected another divisor", parser->location.what);
  struct Quantity result = {.node = divide(parser->graph, a.node, b.node),
                            .dimension = dimension_multiply(a.dimension, b.dimension, -1.0),
                            .factor = factor_of_product(a.factor, factor_raised(b.factor, -1.0)),
                            .literal = a.literal && b.literal};
  require_finite(parser, "a quotient");
  return result;
}

static long line_after_reading(struct Parser *parser) {
  return scope_line(parser->scope, current_line(parser));
}

/*
 * Reports constant powers and roots without a finite real value. A variable base of a fractional power is recorded for
 * the check of domains at the start values.
 */
static void check_power(struct Parser *parser, Node base, Node exponent) {
  const struct Graph *graph = parser->graph;
  bool base_given = graph_is_constant(graph, base), exponent_given = graph_is_constant(graph, exponent);
  double b = graph_value(graph, base), n = graph_value(graph, exponent);
  if (base_given && exponent_given && graph->not_finite && n == 0.5)
    FAIL(parser, "%s: sqrt(%g) is not a real number; expected an argument %s", parser->location.what, b,
         domain_text(POWER));
  else if (base_given && exponent_given && graph->not_finite)
    FAIL(parser, "%s: (%g)^(%g) has no finite value; expected %s", parser->location.what, b, n,
         b < 0 ? "a positive base, or sign(x)*abs(x)^n for an odd root" : "another base or exponent");
  else if (base_given && !exponent_given && b <= 0)
    FAIL(parser, "%s: the base of a power is %g, and its exponent varies; expected a positive base",
         parser->location.what, b);
  require_finite(parser, "a power");
  if (!exponent_given || n != floor(n))
    require_domain(&parser->scope->requirements, graph, POWER, base, line_after_reading(parser));
}

struct Quantity quantity_power(struct Parser *parser, struct Quantity base, struct Quantity exponent) {
  require_dimensionless(parser, exponent, "an exponent");
  struct Quantity result = {.node = power(parser->graph, base.node, exponent.node),
                            .dimension = dimension_unknown,
                            .literal = base.literal && exponent.literal};
  check_power(parser, base.node, exponent.node);
  double n = graph_value(parser->graph, exponent.node);
  if (graph_is_constant(parser->graph, exponent.node)) {
    result.dimension = dimension_multiply(dimension_one, base.dimension, n);
    result.factor = factor_raised(base.factor, n);
  } else if (dimension_agrees(base.dimension, dimension_one)) result.dimension = base.dimension;
  return result;
}

/* Reports a constant value that is not finite. Records a variable argument for the check of domains at the start. */
static void check_function(struct Parser *parser, enum Operation operation, Node argument) {
  if (parser->graph->not_finite)
    FAIL(parser, "%s: %s(%g) has no finite value; expected an argument %s", parser->location.what,
         operation_name(operation), graph_value(parser->graph, argument), domain_text(operation));
  require_domain(&parser->scope->requirements, parser->graph, operation, argument, line_after_reading(parser));
}

struct Quantity quantity_function(struct Parser *parser, enum Operation operation, struct Quantity a,
                                  struct Quantity b) {
  bool has_two = operation_arity(operation) == 2;
  Node node = functions[operation].has_pieces
                  ? piecewise_function(parser->scope, operation, a.node, b.node, current_line(parser))
                  : function(parser->graph, operation, a.node, b.node);
  struct Quantity result = {.node = node, .dimension = dimension_one, .literal = a.literal && (!has_two || b.literal)};
  check_function(parser, operation, a.node);
  if (functions[operation].units == PURE_NUMBERS) {
    char *what = format_text("the argument of %s", operation_name(operation));
    require_dimensionless(parser, a, what);
    if (has_two) require_dimensionless(parser, b, what);
    return result;
  }
  struct Dimension common = has_two ? common_dimension(parser, a, b, operation_name(operation)) : a.dimension;
  if (functions[operation].units != UNIT_KEPT) return result;
  result.dimension = common;
  result.factor = has_two ? factor_of_sum(a, b) : a.factor;
  return result;
}

/* Returns floor(node): in a <set> evaluated at the event, elsewhere piecewise constant with events at its jumps. */
static Node floor_in_place(struct Parser *parser, Node node) {
  bool is_value = (parser->location.kinds & AT_INSTANT) != 0;
  return is_value ? function(parser->graph, FLOOR, node, ZERO) : floor_of(parser->scope, node, current_line(parser));
}

/* Records the expression of mod(a, divisor) for checks, which know its range. */
static void note_remainder(const struct Parser *parser, Node node, Node divisor) {
  bool is_value = (parser->location.kinds & AT_INSTANT) != 0;
  if (parser->scope->switches == NULL || is_value) return;
  append_remainder(parser->scope->switches, (struct Remainder){node, divisor});
}

struct Quantity quantity_rounded(struct Parser *parser, const char *name, struct Quantity a, struct Quantity b) {
  struct Graph *graph = parser->graph;
  struct Quantity result = {.dimension = dimension_one, .literal = a.literal};
  if (strcmp(name, "mod") == 0) {
    result.dimension = common_dimension(parser, a, b, "mod");
    result.literal = a.literal && b.literal;
    if (b.node == ZERO) FAIL(parser, "%s: mod(..., 0) has no value; expected another divisor", parser->location.what);
    Node whole = floor_in_place(parser, divide(graph, a.node, b.node));
    result.node = subtract(graph, a.node, multiply(graph, b.node, whole));
    note_remainder(parser, result.node, b.node);
    return result;
  }
  require_countable(parser, a, name);
  bool is_ceiling = strcmp(name, "ceil") == 0, is_nearest = strcmp(name, "round") == 0;
  Node half = graph_constant(graph, 0.5), argument = is_ceiling ? negate(graph, a.node) : a.node;
  Node floor = floor_in_place(parser, is_nearest ? add(graph, argument, half) : argument);
  result.node = is_ceiling ? negate(graph, floor) : floor;
  return result;
}

/* Reports a number, or the start value of a parameter, that is not whole and would be rounded silently. */
static void require_whole(struct Parser *parser, const char *name, const char *what, Node node) {
  const struct Graph *graph = parser->graph;
  bool is_known = graph_is_constant(graph, node) || parser->scope->model != NULL;
  if ((graph->vertices[node].kinds & ~(1u << PARAMETER)) != 0 || !is_known) return;
  double value = value_at_start(parser->scope, node);
  if (value == floor(value)) return;
  FAIL(parser, "%s: the %s of %s is %g; expected a whole number, such as a parameter of type=\"Integer\"",
       parser->location.what, what, name, value);
}

struct Quantity quantity_random(struct Parser *parser, const char *name, struct Quantity seed, struct Quantity number) {
  struct Graph *graph = parser->graph;
  require_dimensionless(parser, seed, format_text("the seed of %s", name));
  require_dimensionless(parser, number, format_text("the number of %s", name));
  if (!graph_is_constant_in_time(graph, seed.node))
    FAIL(parser, "%s: the seed of %s changes in time; expected a number or a parameter", parser->location.what, name);
  require_whole(parser, name, "seed", seed.node);
  require_whole(parser, name, "number k", number.node);
  bool is_whole = gradient_by_kinds(graph, number.node, ~(1u << PARAMETER | 1u << MODE)).count == 0;
  Node half = graph_constant(graph, 0.5);
  Node k = is_whole ? number.node : floor_in_place(parser, add(graph, number.node, half));
  enum Operation operation = strcmp(name, "gauss") == 0 ? GAUSS : UNIFORM;
  return (struct Quantity){.node = function(graph, operation, seed.node, k), .dimension = dimension_one};
}

static bool check_argument(struct Parser *parser, struct Dimension unit, const char *name, const char *which,
                           struct Quantity argument) {
  if (argument.literal || scope_units_agree(parser->scope, argument.dimension, unit)) return true;
  char *problem = format_text("%s: unit mismatch: the %sargument of '%s' has the unit %s, expected %s",
                              parser->location.what, which, name, unit_text(argument.dimension), unit_text(unit));
  if (number_may_have_unit(parser->scope, current_line(parser), argument, unit, problem)) return true;
  FAIL(parser, "%s%s", problem, unit_hint(argument.dimension));
  return false;
}

struct Quantity quantity_of_table(struct Parser *parser, const struct Table *table, const char *name,
                                  const struct Quantity arguments[2]) {
  struct Quantity value = {.node = ZERO, .dimension = table->value};
  const Node nodes[2] = {arguments[0].node, arguments[1].node};
  bool has_two = table->has_two_arguments;
  if (!check_argument(parser, table->arguments[0], name, has_two ? "first " : "", arguments[0])) return value;
  if (has_two && !check_argument(parser, table->arguments[1], name, "second ", arguments[1])) return value;
  value.node = table_at(parser->scope, table, nodes, current_line(parser));
  return value;
}
