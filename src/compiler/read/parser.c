#include "read/parser.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "algebra/simplify.h"

enum { NESTING_LIMIT = 1000, REPETITION_LIMIT = 100000 };

struct Parser {
  struct Scope *scope;
  struct Graph *graph;
  struct Place place;
  const char *text, *next;
  int nesting;
  long repetitions; /* bodies of sum(...) parsed so far */
  bool failed;
};

static const char *const kind_names[SYMBOL_KIND_COUNT] = {
    [PARAMETER] = "parameters", [TIME] = "time",    [COORDINATE] = "coordinates",
    [VELOCITY] = "velocities",  [INPUT] = "inputs", [ACCELERATION] = "accelerations",
};

static const struct Quantity nothing = {.node = ZERO};

static struct Quantity parse_sum(struct Parser *parser);
static struct Quantity parse_sign(struct Parser *parser);

static long current_line(const struct Parser *parser) {
  long line = parser->place.line;
  for (const char *c = parser->text; c < parser->next; c++) line += *c == '\n';
  return line;
}

/* Reports the first error of an expression; later ones would only follow from it. */
#define FAIL(parser, ...)                                                                                              \
  do {                                                                                                                 \
    if (!(parser)->failed) report_error((parser)->scope->diagnostics, current_line(parser), __VA_ARGS__);              \
    (parser)->failed = true;                                                                                           \
  } while (0)

/* Recursion is bounded here, so that no input exhausts the stack. */
static void enter(struct Parser *parser) {
  if (++parser->nesting > NESTING_LIMIT + 1)
    FAIL(parser, "%s: more than %d nested parentheses or powers; expected fewer, or a <define> for a part",
         parser->place.what, NESTING_LIMIT);
}

static void skip_space(struct Parser *parser) {
  while (isspace((unsigned char)*parser->next)) parser->next++;
}

/* What stands at the reading position, for messages. */
static const char *found(const struct Parser *parser, char buffer[32]) {
  if (*parser->next == '\0') return "the end";
  size_t length = 1;
  if (isalnum((unsigned char)*parser->next))
    while (length < 24 && isalnum((unsigned char)parser->next[length])) length++;
  else
    while (length < 4 && ((unsigned char)parser->next[length] & 0xC0u) == 0x80u) length++;
  snprintf(buffer, 32, "'%.*s'", (int)length, parser->next);
  return buffer;
}

static bool accept(struct Parser *parser, char c) {
  skip_space(parser);
  if (*parser->next != c) return false;
  parser->next++;
  return true;
}

static void expect(struct Parser *parser, char c, const char *context) {
  char buffer[32];
  if (parser->failed || accept(parser, c)) return;
  FAIL(parser, "%s: expected '%c' %s, found %s", parser->place.what, c, context, found(parser, buffer));
}

static struct Quantity require_dimensionless(struct Parser *parser, struct Quantity value, const char *what) {
  if (scope_units_agree(parser->scope, value.dimension, dimension_one)) return value;
  char *unit = unit_text(value.dimension);
  FAIL(parser, "%s: unit mismatch: %s has the unit %s, expected 1 or rad", parser->place.what, what, unit);
  free(unit);
  return value;
}

/* The dimension of a sum, a minimum and the like, whose operands must agree. */
static struct Dimension common_dimension(struct Parser *parser, struct Quantity a, struct Quantity b,
                                         const char *where) {
  if (a.literal) return b.dimension;
  if (b.literal) return a.dimension;
  if (!scope_units_agree(parser->scope, a.dimension, b.dimension)) {
    char *first = unit_text(a.dimension), *second = unit_text(b.dimension);
    FAIL(parser, "%s: unit mismatch: %s and %s in one %s; expected the same unit", parser->place.what, first, second,
         where);
    free(first);
    free(second);
  }
  return a.dimension.known ? a.dimension : b.dimension;
}

static struct Quantity parse_literal(struct Parser *parser) {
  char *end;
  if (parser->next[0] == '0' && (parser->next[1] == 'x' || parser->next[1] == 'X')) {
    FAIL(parser, "%s: '0x' is no number here; expected a decimal number", parser->place.what);
    return nothing;
  }
  double value = strtod(parser->next, &end);
  if (end == parser->next || !isfinite(value) || isalnum((unsigned char)*end) || *end == '_' || *end == '.') {
    FAIL(parser, "%s: '%.12s' is no number; expected one such as 2, 0.5 or 1e-3 (write * for a product)",
         parser->place.what, parser->next);
    return nothing;
  }
  parser->next = end;
  /* 9.81 may carry a hidden unit, 2 and 0.5 are pure numbers. */
  bool pure = 2 * value == floor(2 * value);
  return (struct Quantity){.node = graph_constant(parser->graph, value),
                           .dimension = pure ? dimension_one : dimension_unknown,
                           .literal = true};
}

/* Whether all numbers made of numbers since the expression began are finite. */
static bool require_finite(struct Parser *parser, const char *what) {
  if (parser->graph->not_finite)
    FAIL(parser, "%s: %s of numbers is not finite; expected numbers below 1e308", parser->place.what, what);
  return !parser->failed;
}

/* A whole number from an expression of compile-time numbers. */
static long parse_whole(struct Parser *parser, const char *what) {
  unsigned kinds = parser->place.kinds;
  parser->place.kinds = 0;
  struct Quantity value = parse_sum(parser);
  parser->place.kinds = kinds;
  if (parser->failed) return 0;
  double number = graph_is_constant(parser->graph, value.node) ? graph_value(parser->graph, value.node) : NAN;
  if (number == floor(number) && fabs(number) < 1e9) return (long)number;
  FAIL(parser, "%s: %s is no whole number known when compiling", parser->place.what, what);
  return 0;
}

static char *read_identifier(struct Parser *parser) {
  size_t length = 0;
  while (isalnum((unsigned char)parser->next[length]) || parser->next[length] == '_') length++;
  char *identifier = format_text("%.*s", (int)length, parser->next);
  parser->next += length;
  return identifier;
}

/* The rest of a name after its identifier: an index, a component. Takes and returns an allocated string. */
static char *read_name_suffix(struct Parser *parser, char *name) {
  if (*parser->next == '[') {
    parser->next++;
    long index = parse_whole(parser, "the index in brackets");
    if (index < 0)
      FAIL(parser, "%s: the index of %s[%ld] is negative; expected 0, 1, 2, ...", parser->place.what, name, index);
    expect(parser, ']', "after the index");
    char *indexed = format_text("%s[%ld]", name, index);
    free(name);
    name = indexed;
  }
  if (*parser->next == '.' && isalpha((unsigned char)parser->next[1])) {
    parser->next++;
    char *component = read_identifier(parser), *whole = format_text("%s.%s", name, component);
    free(component);
    free(name);
    name = whole;
  }
  return name;
}

static void report_unknown_name(struct Parser *parser, const char *name) {
  /* A search through all names is for messages that are shown. */
  bool shown = parser->scope->diagnostics->errors < ERROR_LIMIT;
  const char *similar = shown ? scope_similar_name(parser->scope, name) : NULL;
  if (similar != NULL) FAIL(parser, "%s: unknown name '%s'; did you mean '%s'?", parser->place.what, name, similar);
  else
    FAIL(parser, "%s: unknown name '%s'; expected a parameter, coordinate, velocity, input, definition or time",
         parser->place.what, name);
}

static struct Quantity look_up(struct Parser *parser, const char *name) {
  const struct Quantity *quantity = scope_find(parser->scope, name);
  if (quantity == NULL) {
    report_unknown_name(parser, name);
    return nothing;
  }
  if (graph_is_constant(parser->graph, quantity->node) && isnan(graph_value(parser->graph, quantity->node)))
    FAIL(parser, "%s: '%s' is no variable; expected a parameter, coordinate, velocity, input, definition or time",
         parser->place.what, name);
  unsigned surplus = parser->graph->vertices[quantity->node].kinds & ~parser->place.kinds;
  for (int kind = 0; kind < SYMBOL_KIND_COUNT; kind++)
    if ((surplus >> kind & 1u) != 0)
      FAIL(parser, "%s cannot depend on %s, but '%s' does", parser->place.what, kind_names[kind], name);
  return *quantity;
}

/* Bounds with names may cross on purpose: sum(j, 2, i-1, ...) is empty for the first i. */
static bool bounds_are_numbers(const char *begin, const char *end) {
  while (begin < end && !isalpha((unsigned char)*begin)) begin++;
  return begin == end;
}

/* sum(index, first, last, body): the body is read once for each value of the index. */
static struct Quantity parse_repeated_sum(struct Parser *parser) {
  char buffer[32];
  skip_space(parser);
  if (!isalpha((unsigned char)*parser->next) && *parser->next != '_')
    FAIL(parser, "%s: expected a name as the index of sum(index, first, last, expression), found %s",
         parser->place.what, found(parser, buffer));
  char *index = read_identifier(parser);
  expect(parser, ',', "after the index of sum(index, first, last, expression)");
  const char *bounds = parser->next;
  long first = parse_whole(parser, "the first index of sum(...)");
  expect(parser, ',', "after the first index");
  long last = parse_whole(parser, "the last index of sum(...)");
  if (last < first - 1 && bounds_are_numbers(bounds, parser->next))
    FAIL(parser, "%s: sum(...) from %ld to %ld runs backwards; expected the smaller number first", parser->place.what,
         first, last);
  expect(parser, ',', "after the last index");
  if (!parser->failed && scope_find(parser->scope, index) != NULL)
    FAIL(parser, "%s: the index '%s' of sum(...) is already a name; expected a new one", parser->place.what, index);
  const char *body = parser->next;
  struct Quantity total = {.node = ZERO, .dimension = dimension_unknown, .literal = true};
  /* An empty sum still reads its body once, to find where it ends; the result is dropped. */
  for (long i = first; !parser->failed && (i <= last || i == first); i++) {
    if (++parser->repetitions > REPETITION_LIMIT)
      FAIL(parser, "%s: sum(...) has more than %d terms", parser->place.what, REPETITION_LIMIT);
    parser->next = body;
    scope_set_number(parser->scope, index, (double)i);
    struct Quantity term = parse_sum(parser);
    if (first > last) continue;
    total.dimension = common_dimension(parser, total, term, "sum");
    total.literal = total.literal && term.literal;
    total.node = add(parser->graph, total.node, term.node);
    require_finite(parser, "a sum");
  }
  scope_remove(parser->scope, index);
  free(index);
  expect(parser, ')', "at the end of sum(...)");
  return total;
}

static struct Quantity parse_derivative(struct Parser *parser) {
  unsigned allowed = parser->place.kinds;
  parser->place.kinds &= ~((1u << INPUT) | (1u << ACCELERATION));
  struct Quantity value = parse_sum(parser);
  parser->place.kinds = allowed;
  expect(parser, ')', "at the end of der(...)");
  Node derivative = parser->failed ? ZERO : total_time_derivative(parser->scope, value.node);
  for (int kind = VELOCITY; kind <= ACCELERATION; kind++)
    if ((allowed & 1u << kind) == 0 && graph_depends_on(parser->graph, derivative, (enum SymbolKind)kind))
      FAIL(parser, "%s cannot depend on %s, but der(...) does", parser->place.what, kind_names[kind]);
  if (parser->failed) return nothing;
  struct Dimension second;
  const char *problem;
  unit_parse("s", &second, &problem);
  return (struct Quantity){.node = derivative, .dimension = dimension_multiply(value.dimension, second, -1.0)};
}

/* A power or root of numbers that has a finite value, or of what may have one. */
static void check_power(struct Parser *parser, Node base, Node exponent) {
  const struct Graph *graph = parser->graph;
  bool base_given = graph_is_constant(graph, base), exponent_given = graph_is_constant(graph, exponent);
  double b = graph_value(graph, base), n = graph_value(graph, exponent);
  if (base_given && exponent_given && graph->not_finite && n == 0.5)
    FAIL(parser, "%s: sqrt(%g) is no real number; expected an argument %s", parser->place.what, b, domain_text(POWER));
  else if (base_given && exponent_given && graph->not_finite)
    FAIL(parser, "%s: (%g)^(%g) has no finite value; expected another base or exponent", parser->place.what, b, n);
  else if (base_given && !exponent_given && b <= 0)
    FAIL(parser, "%s: a power of %g with an exponent that varies; expected a positive base", parser->place.what, b);
  require_finite(parser, "a power");
  if (!exponent_given || n != floor(n))
    require_domain(&parser->scope->requirements, graph, POWER, base, current_line(parser));
}

static struct Quantity raise_to(struct Parser *parser, struct Quantity base, struct Quantity exponent) {
  require_dimensionless(parser, exponent, "an exponent");
  struct Quantity result = {.node = power(parser->graph, base.node, exponent.node),
                            .dimension = dimension_unknown,
                            .literal = base.literal && exponent.literal};
  check_power(parser, base.node, exponent.node);
  if (graph_is_constant(parser->graph, exponent.node))
    result.dimension = dimension_multiply(dimension_one, base.dimension, graph_value(parser->graph, exponent.node));
  else if (dimension_agrees(base.dimension, dimension_one)) result.dimension = base.dimension;
  return result;
}

/* A function of numbers must have a finite value; one of variables must have one where these are. */
static void check_function(struct Parser *parser, enum Operation operation, Node argument) {
  if (parser->graph->not_finite)
    FAIL(parser, "%s: %s(%g) has no finite value; expected an argument %s", parser->place.what,
         operation_name(operation), graph_value(parser->graph, argument), domain_text(operation));
  require_domain(&parser->scope->requirements, parser->graph, operation, argument, current_line(parser));
}

static struct Quantity apply(struct Parser *parser, enum Operation operation, struct Quantity a, struct Quantity b) {
  struct Quantity result = {.node = function(parser->graph, operation, a.node, b.node),
                            .dimension = dimension_one,
                            .literal = a.literal && (operation_arity(operation) == 1 || b.literal)};
  check_function(parser, operation, a.node);
  if (operation == ABSOLUTE) result.dimension = a.dimension;
  else if (operation == MINIMUM || operation == MAXIMUM)
    result.dimension = common_dimension(parser, a, b, operation_name(operation));
  else if (operation == ATAN2) common_dimension(parser, a, b, "atan2");
  else if (operation != SIGN) {
    char *what = format_text("the argument of %s", operation_name(operation));
    require_dimensionless(parser, a, what);
    free(what);
  }
  return result;
}

static struct Quantity parse_call(struct Parser *parser, const char *name) {
  if (strcmp(name, "sum") == 0) return parse_repeated_sum(parser);
  if (strcmp(name, "der") == 0) return parse_derivative(parser);
  bool root = strcmp(name, "sqrt") == 0, raise = strcmp(name, "pow") == 0;
  int operation = ATAN2;
  while (operation < OPERATION_COUNT &&
         (operation == LESS || strcmp(name, operation_name((enum Operation)operation)) != 0))
    operation++;
  if (operation == OPERATION_COUNT && !root && !raise) {
    FAIL(parser,
         "%s: unknown function '%s'; expected sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, asinh, "
         "acosh, atanh, exp, log, sqrt, pow, abs, sign, min, max, der or sum",
         parser->place.what, name);
    return nothing;
  }
  int arity = root ? 1 : raise ? 2 : operation_arity((enum Operation)operation);
  struct Quantity a = parse_sum(parser), b = nothing;
  if (arity == 2) {
    char *context = format_text("between the two arguments of %s", name);
    expect(parser, ',', context);
    free(context);
    if (!parser->failed) b = parse_sum(parser);
  }
  char *context = format_text("after the %s of %s", arity == 1 ? "argument" : "two arguments", name);
  expect(parser, ')', context);
  free(context);
  if (parser->failed) return nothing;
  if (root) b = (struct Quantity){.node = graph_constant(parser->graph, 0.5), .dimension = dimension_one};
  return root || raise ? raise_to(parser, a, b) : apply(parser, (enum Operation)operation, a, b);
}

static struct Quantity parse_primary(struct Parser *parser) {
  char buffer[32];
  skip_space(parser);
  char c = *parser->next;
  if (isdigit((unsigned char)c) || (c == '.' && isdigit((unsigned char)parser->next[1]))) return parse_literal(parser);
  if (c == '(') {
    parser->next++;
    struct Quantity value = parse_sum(parser);
    expect(parser, ')', "to close a parenthesis");
    return value;
  }
  if (!isalpha((unsigned char)c) && c != '_') {
    FAIL(parser, "%s: expected a number, a name or '(', found %s", parser->place.what, found(parser, buffer));
    return nothing;
  }
  char *name = read_identifier(parser);
  const char *end = parser->next;
  bool call = accept(parser, '(');
  if (!call) {
    parser->next = end; /* an error about the name is on its line */
    name = read_name_suffix(parser, name);
  }
  struct Quantity value = nothing;
  if (!parser->failed) value = call ? parse_call(parser, name) : look_up(parser, name);
  free(name);
  return value;
}

static struct Quantity parse_power(struct Parser *parser) {
  struct Quantity base = parse_primary(parser);
  if (parser->failed || !accept(parser, '^')) return base;
  enter(parser);
  struct Quantity exponent = parser->failed ? nothing : parse_sign(parser);
  parser->nesting--;
  return parser->failed ? nothing : raise_to(parser, base, exponent);
}

static struct Quantity parse_sign(struct Parser *parser) {
  bool negative = false;
  for (skip_space(parser); *parser->next == '-' || *parser->next == '+'; skip_space(parser))
    negative ^= *parser->next++ == '-';
  struct Quantity value = parse_power(parser);
  if (negative) value.node = negate(parser->graph, value.node);
  return value;
}

static struct Quantity parse_term(struct Parser *parser) {
  struct Quantity value = parse_sign(parser);
  while (!parser->failed) {
    bool division = false;
    if (!accept(parser, '*')) {
      if (!accept(parser, '/')) break;
      division = true;
    }
    struct Quantity factor = parse_sign(parser);
    if (parser->failed) break;
    if (division && factor.node == ZERO) FAIL(parser, "%s: division by zero", parser->place.what);
    value.node =
        division ? divide(parser->graph, value.node, factor.node) : multiply(parser->graph, value.node, factor.node);
    if (!require_finite(parser, division ? "a quotient" : "a product")) break;
    value.dimension = dimension_multiply(value.dimension, factor.dimension, division ? -1.0 : 1.0);
    value.literal = value.literal && factor.literal;
  }
  return value;
}

static struct Quantity parse_sum(struct Parser *parser) {
  enter(parser);
  if (parser->failed) return nothing;
  struct Quantity value = parse_term(parser);
  while (!parser->failed) {
    bool minus = false;
    if (!accept(parser, '+')) {
      if (!accept(parser, '-')) break;
      minus = true;
    }
    struct Quantity term = parse_term(parser);
    if (parser->failed) break;
    value.dimension = common_dimension(parser, value, term, "sum");
    value.literal = value.literal && term.literal;
    value.node = (minus ? subtract : add)(parser->graph, value.node, term.node);
    if (!require_finite(parser, "a sum")) break;
  }
  parser->nesting--;
  return value;
}

struct Quantity parse_expression(struct Scope *scope, const char *text, struct Place place) {
  struct Parser parser = {.scope = scope, .graph = scope->graph, .place = place, .text = text, .next = text};
  char buffer[32];
  scope->graph->not_finite = false;
  struct Quantity value = parse_sum(&parser);
  skip_space(&parser);
  if (!parser.failed && *parser.next == ')')
    FAIL(&parser, "%s: ')' without '('; expected an operator or the end", place.what);
  if (!parser.failed && *parser.next != '\0')
    FAIL(&parser, "%s: expected an operator or the end, found %s", place.what, found(&parser, buffer));
  if (!parser.failed && parser.graph->overflow)
    FAIL(&parser, "%s: the system is too large: more than %d operations", place.what, NODE_LIMIT);
  return parser.failed ? nothing : value;
}

bool parse_number(struct Scope *scope, const char *text, struct Place place, double *value) {
  place.kinds = 0;
  int errors = scope->diagnostics->errors;
  struct Quantity quantity = parse_expression(scope, text, place);
  if (scope->diagnostics->errors > errors) return false;
  *value = graph_value(scope->graph, quantity.node);
  return true;
}

char *parse_name(struct Scope *scope, const char *text, struct Place place) {
  struct Parser parser = {.scope = scope, .graph = scope->graph, .place = place, .text = text, .next = text};
  char *name = NULL;
  if (isalpha((unsigned char)*text) || *text == '_') name = read_name_suffix(&parser, read_identifier(&parser));
  if (name == NULL || *parser.next != '\0' || strchr(name, '.') != NULL)
    FAIL(&parser, "%s: '%s' is no name; expected letters, digits and _, or name[index]", place.what, text);
  if (!parser.failed) return name;
  free(name);
  return NULL;
}

void define_language(struct Scope *scope) {
  static const char *const functions[] = {"sqrt", "pow", "sum", "der"};
  scope_set_number(scope, "pi", M_PI);
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) scope_set_number(scope, functions[i], NAN);
  for (int operation = ATAN2; operation < OPERATION_COUNT; operation++)
    if (operation != LESS) scope_set_number(scope, operation_name((enum Operation)operation), NAN);
}
