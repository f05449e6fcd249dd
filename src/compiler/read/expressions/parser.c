#include "read/expressions/parser.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/switches.h"
#include "read/expressions/constructs.h"
#include "read/expressions/named_functions.h"
#include "read/expressions/quantities.h"
#include "names/piecewise_functions.h"
#include "names/hints.h"
#include "names/words.h"
#include "read/tables/table.h"

/*
 * Limits of the recursion depth and of the terms of all sums in an expression, and the units of work charged for each
 * primary expression. They bound the stack and the time of compilation.
 */
enum { NESTING_LIMIT = 1000, REPETITION_LIMIT = 100000, PRIMARY_WORK = 50 };

static const char *const kind_names[SYMBOL_KIND_COUNT] = {
    [PARAMETER] = "parameters",
    [TIME] = "time",
    [COORDINATE] = "coordinates",
    [VELOCITY] = "velocities",
    [STATE] = "states",
    [INPUT] = "inputs",
    [ACCELERATION] = "accelerations",
    [DISPLACEMENT] = "displacements",
    [REACTION] = "forces of reaction",
    [MODE] = "modes",
};

/* Begins the subject of messages about the argument of der(...). */
static const char derived[] = "der(...) in ";
static const char no_derivative[] = "; expected coordinates or velocities, whose derivatives the system knows";

static bool is_derived(const char *what) {
  return strncmp(what, derived, strlen(derived)) == 0;
}

static const struct Quantity nothing = {.node = ZERO};

static struct Quantity parse_sign(struct Parser *parser);

/* Counts a level of recursion, up to a limit, so that no input overflows the stack. */
static void enter(struct Parser *parser) {
  if (++parser->nesting > NESTING_LIMIT + 1)
    FAIL(parser, "%s: parentheses or powers are nested more than %d deep; expected fewer, or a <define> for a part",
         parser->location.what, NESTING_LIMIT);
}

static struct Quantity parse_literal(struct Parser *parser) {
  char *end;
  if (parser->next[0] == '0' && (parser->next[1] == 'x' || parser->next[1] == 'X')) {
    FAIL(parser, "%s: '0x' is not a number here; expected a decimal number", parser->location.what);
    return nothing;
  }
  double value = strtod(parser->next, &end);
  if (isinf(value)) {
    FAIL(parser, "%s: '%.*s' is too large for a number; expected one below 1e308", parser->location.what,
         (int)(end - parser->next), parser->next);
    return nothing;
  }
  if (end == parser->next || !isfinite(value) || isalnum((unsigned char)*end) || *end == '_' || *end == '.') {
    if (end > parser->next && strncmp(end, "deg", 3) == 0)
      FAIL(parser, "%s: '%.12s' is not a number; write radians, as in %.*s*pi/180", parser->location.what, parser->next,
           (int)(end - parser->next), parser->next);
    else
      FAIL(parser, "%s: '%.12s' is not a number; expected one such as 2, 0.5 or 1e-3 (write * for a product)",
           parser->location.what, parser->next);
    return nothing;
  }
  char *text = format_text("%.*s", (int)(end - parser->next), parser->next);
  parser->next = end;
  return (struct Quantity){.node = graph_constant(parser->graph, value),
                           .dimension = dimension_one,
                           .factor = {.text = text, .power = 1.0},
                           .literal = true};
}

long parse_whole(struct Parser *parser, const char *what) {
  const struct Location location = parser->location;
  parser->location.kinds = 0;
  parser->location.what = format_text("%s: %s", location.what, what);
  struct Quantity value = parse_sum(parser);
  parser->location = location;
  if (parser->failed) return 0;
  double number = graph_is_constant(parser->graph, value.node) ? graph_value(parser->graph, value.node) : NAN;
  if (number == floor(number) && fabs(number) < 1e9) return (long)number;
  FAIL(parser, "%s: %s is not a whole number that is known at build time; expected numbers and constants",
       parser->location.what, what);
  return 0;
}

static char *read_identifier(struct Parser *parser) {
  size_t length = 0;
  while (isalnum((unsigned char)parser->next[length]) || parser->next[length] == '_') length++;
  char *identifier = format_text("%.*s", (int)length, parser->next);
  parser->next += length;
  return identifier;
}

/* Appends the index after an identifier, if there is one. */
static char *read_index(struct Parser *parser, char *name) {
  if (*parser->next == '[') {
    parser->next++;
    long index = parse_whole(parser, "the index in brackets");
    if (index < 0)
      FAIL(parser, "%s: the index of %s[%ld] is negative; expected 0, 1, 2, ...", parser->location.what, name, index);
    expect_character(parser, ']', "after the only index of a name");
    name = format_text("%s[%ld]", name, index);
  }
  return name;
}

/* Appends the index and the further parts of a name after its first identifier. */
static char *read_name_suffix(struct Parser *parser, char *name) {
  name = read_index(parser, name);
  while (!parser->failed && *parser->next == '.' &&
         (isalpha((unsigned char)parser->next[1]) || parser->next[1] == '_')) {
    parser->next++;
    char *part = read_identifier(parser), *whole = format_text("%s.%s", name, part);
    name = read_index(parser, whole);
  }
  return name;
}

char *read_name(struct Parser *parser) {
  char *identifier = read_identifier(parser);
  return read_name_suffix(parser, identifier);
}

/* Returns how many time derivatives of an input are inputs themselves. */
static int derivatives_of_input(const struct Scope *scope, Node symbol) {
  int count = 0;
  while ((symbol = time_derivative_of_symbol(scope, symbol)) != ZERO) count++;
  return count;
}

/* Reports inputs in a node that lack the time derivatives needed here. name: the name that stands for the node. */
static void require_input_derivatives(struct Parser *parser, Node node, const char *name) {
  const struct Graph *graph = parser->graph;
  int needed = parser->location.input_derivatives;
  if (needed == 0 || parser->failed || !graph_depends_on(graph, node, INPUT)) return;
  cone_collect(graph->cone, graph, &node, 1);
  for (size_t i = 0; i < graph->cone->count; i++) {
    Node symbol = graph->cone->nodes[i];
    if (graph->vertices[symbol].operation != SYMBOL || !graph_depends_on(graph, symbol, INPUT)) continue;
    int known = derivatives_of_input(parser->scope, symbol);
    const char *input = graph_symbol_of(graph, symbol)->name;
    if (known == 0 && is_derived(parser->location.what))
      FAIL(parser, "%s cannot depend on inputs, but '%s' does%s, or an <input> with derivatives=\"%d\"",
           parser->location.what, name, no_derivative, needed);
    else if (known == 0)
      FAIL(parser,
           "%s cannot depend on inputs, but '%s' does; use it in a <force>, or write derivatives=\"2\" of an <input> "
           "that moves something",
           parser->location.what, name);
    else if (known < needed && needed > 2)
      FAIL(parser, "%s needs %d time derivatives of the input '%s'; expected at most 2", parser->location.what, needed,
           input);
    else if (known < needed)
      FAIL(parser, "%s needs 2 time derivatives of the input '%s', of which 1 is known; expected derivatives=\"2\"",
           parser->location.what, input);
  }
}

/*
 * Returns a definition as <set> evaluates it: piecewise functions that <set> alone uses are evaluated without events.
 */
static struct Quantity evaluated_at_event(const struct Parser *parser, struct Quantity quantity) {
  if ((parser->location.kinds & AT_INSTANT) == 0 || quantity.whole == ZERO) return quantity;
  quantity.node = parser->scope->keeps_whole ? quantity.whole : quantity.at_instant;
  return quantity;
}

struct Quantity look_up(struct Parser *parser, const char *name) {
  const struct Quantity *quantity = find_quantity(parser, name);
  char *full_name = quantity == NULL ? scope_full_name(parser->scope, name) : NULL;
  if (quantity == NULL && definitions_parse_now(parser->scope->definitions, full_name))
    quantity = scope_find(parser->scope, full_name);
  if (quantity == NULL) {
    if (!definitions_wait_for(parser->scope->definitions, full_name)) report_unknown_name(parser, name);
    return nothing;
  }
  if (scope_is_reserved(parser->scope, quantity)) report_reserved(parser, name);
  unsigned surplus = deciding_kinds(parser->scope, quantity->node) & ~(parser->location.kinds | 1u << DUMMY);
  for (int kind = 0; kind < SYMBOL_KIND_COUNT; kind++)
    if ((surplus >> kind & 1u) != 0)
      FAIL(parser, "%s cannot depend on %s, but '%s' does%s", parser->location.what, kind_names[kind], name,
           is_derived(parser->location.what) ? no_derivative
                                             : hint_for_kind((enum SymbolKind)kind, parser->location.kinds));
  if ((surplus & CONTACT_STATE) != 0)
    FAIL(
        parser,
        "%s cannot depend on whether contacts are closed and frictions slide, but '%s' does; expected it in an <event> "
        "or an <output>, such as an <event> that sets a <mode>",
        parser->location.what, name);
  require_input_derivatives(parser, quantity->node, name);
  return evaluated_at_event(parser, *quantity);
}

/* True if both bounds are literals. Others may be reversed on purpose: sum(j, 2, i-1, ...) is empty for i = 1. */
static bool bounds_are_numbers(const char *begin, const char *end) {
  while (begin < end && !isalpha((unsigned char)*begin)) begin++;
  return begin == end;
}

/* Skips to the parenthesis that closes the current call. The skipped text may contain unknown names. */
static void skip_to_end(struct Parser *parser) {
  for (int depth = 0; *parser->next != '\0' && !(depth == 0 && *parser->next == ')'); parser->next++)
    depth += (*parser->next == '(') - (*parser->next == ')');
}

static struct Quantity number_of(const struct Parser *parser, double number) {
  return (struct Quantity){.node = graph_constant(parser->graph, number), .dimension = dimension_one, .literal = true};
}

/* The part of sum(index, first, last, body) before the body. */
struct SumHead {
  char *index;
  long first, last;
};

char *parse_declared(struct Parser *parser, const char *what, const char *usage) {
  char buffer[32];
  skip_space(parser);
  if (!isalpha((unsigned char)*parser->next) && *parser->next != '_')
    FAIL(parser, "%s: expected a name as the %s of %s, found %s", parser->location.what, what, usage,
         found(parser, buffer));
  char *name = read_identifier(parser);
  expect_character(parser, ',', format_text("after the %s of %s", what, usage));
  return name;
}

void require_new_name(struct Parser *parser, const char *what, const char *name, const char *function) {
  if (parser->failed) return;
  char *full_name = scope_full_name(parser->scope, name);
  bool is_known = find_quantity(parser, name) != NULL || definitions_contain(parser->scope->definitions, full_name);
  release(full_name);
  if (is_known)
    FAIL(parser, "%s: the %s '%s' of %s(...) is already defined; expected another name", parser->location.what, what,
         name, function);
}

static struct SumHead parse_sum_head(struct Parser *parser) {
  struct SumHead head = {.index = parse_declared(parser, "index", "sum(index, first, last, expression)")};
  const char *bounds = parser->next;
  head.first = parse_whole(parser, "the first index of sum(...)");
  expect_character(parser, ',', "after the first index");
  head.last = parse_whole(parser, "the last index of sum(...)");
  if (head.last < head.first - 1 && bounds_are_numbers(bounds, parser->next))
    FAIL(parser, "%s: sum(...) from %ld to %ld runs backwards; expected the smaller number first",
         parser->location.what, head.first, head.last);
  expect_character(parser, ',', "after the last index");
  require_new_name(parser, "index", head.index, "sum");
  return head;
}

/* Parses the body once for each value of the index. */
static struct Quantity parse_repeated_sum(struct Parser *parser) {
  const struct SumHead head = parse_sum_head(parser);
  const char *body = parser->next;
  struct Quantity total = {.node = ZERO, .dimension = dimension_unknown, .literal = true};
  struct Local index = {.name = head.index, .outer = parser->locals};
  parser->locals = &index;
  if (head.first > head.last) skip_to_end(parser);
  for (long i = head.first; !parser->failed && i <= head.last; i++) {
    if (++parser->repetitions > REPETITION_LIMIT)
      FAIL(parser, "%s: sum(...) has more than %d terms; expected fewer", parser->location.what, REPETITION_LIMIT);
    parser->next = body;
    index.value = number_of(parser, (double)i);
    total = quantity_add(parser, total, parse_sum(parser));
  }
  parser->locals = index.outer;
  expect_character(parser, ')', "at the end of sum(...)");
  return total;
}

/* True if the current expression must wait for the rate of a state in the node, which has not been parsed. */
static bool waits_for_rates(struct Parser *parser, Node node) {
  const struct Graph *graph = parser->graph;
  bool waits = false;
  if (!graph_depends_on(graph, node, STATE)) return false;
  cone_collect(graph->cone, graph, &node, 1);
  for (size_t i = 0; i < graph->cone->count; i++) {
    Node symbol = graph->cone->nodes[i];
    if (graph->vertices[symbol].operation != SYMBOL || !graph_depends_on(graph, symbol, STATE)) continue;
    const char *rate = format_text("der(%s)", graph_symbol_of(graph, symbol)->name);
    if (scope_find(parser->scope, rate) == NULL) waits |= definitions_wait_for(parser->scope->definitions, rate);
  }
  return waits;
}

/* Parses der(...). Accelerations, reaction forces and inputs without a time derivative are errors in its argument. */
static struct Quantity parse_derivative(struct Parser *parser) {
  const struct Location location = parser->location;
  parser->location.kinds &= ~((1u << ACCELERATION) | (1u << REACTION));
  parser->location.input_derivatives++;
  parser->location.what = format_text("%s%s", derived, location.what);
  struct Quantity value = parse_sum(parser);
  parser->location = location;
  expect_character(parser, ')', "at the end of der(...)");
  if (!parser->failed && waits_for_rates(parser, value.node)) return nothing;
  Node derivative = parser->failed ? ZERO : total_time_derivative(parser->scope, value.node);
  for (int kind = VELOCITY; kind <= ACCELERATION; kind++)
    if ((location.kinds & 1u << kind) == 0 && graph_depends_on(parser->graph, derivative, (enum SymbolKind)kind))
      FAIL(parser, "%s cannot depend on %s, but der(...) does%s", location.what, kind_names[kind],
           is_derived(location.what) ? no_derivative : hint_for_kind((enum SymbolKind)kind, location.kinds));
  if (parser->failed) return nothing;
  return (struct Quantity){
      .node = derivative, .dimension = dimension_multiply(value.dimension, unit_of("s"), -1.0), .factor = value.factor};
}

static struct Quantity parse_table(struct Parser *parser, const struct Table *table, const char *name) {
  bool has_two = table->has_two_arguments;
  struct Quantity arguments[2] = {parse_sum(parser), nothing};
  if (has_two) expect_character(parser, ',', "between the two arguments of a table");
  if (has_two && !parser->failed) arguments[1] = parse_sum(parser);
  expect_character(parser, ')', has_two ? "after the two arguments of a table" : "after the argument of a table");
  return parser->failed ? nothing : quantity_of_table(parser, table, name, arguments);
}

/* Returns the table that the current file calls by this name; NULL for none. */
static const struct Table *find_table(const struct Parser *parser, const char *name) {
  char *full_name = scope_full_name(parser->scope, name);
  const struct Table *table = table_named(parser->scope, full_name);
  release(full_name);
  return table;
}

/* Parses one or two arguments and the closing parenthesis. */
static void parse_operands(struct Parser *parser, const char *name, int arity, struct Quantity *a, struct Quantity *b) {
  *a = parse_sum(parser);
  *b = nothing;
  if (arity == 2) {
    expect_character(parser, ',', format_text("between the two arguments of %s", name));
    if (!parser->failed) *b = parse_sum(parser);
  }
  expect_character(parser, ')', format_text("after the %s of %s", arity == 1 ? "argument" : "two arguments", name));
}

static bool is_rounding(const char *name) {
  static const char *const names[] = {"floor", "ceil", "round", "mod"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(name, names[i]) == 0) return true;
  return false;
}

static struct Quantity parse_rounding(struct Parser *parser, const char *name) {
  struct Quantity a, b;
  parse_operands(parser, name, strcmp(name, "mod") == 0 ? 2 : 1, &a, &b);
  return parser->failed ? nothing : quantity_rounded(parser, name, a, b);
}

static struct Quantity parse_random(struct Parser *parser, const char *name) {
  struct Quantity seed, number;
  parse_operands(parser, name, 2, &seed, &number);
  return parser->failed ? nothing : quantity_random(parser, name, seed, number);
}

static struct NamedFunction *find_named_function(const struct Parser *parser, const char *name) {
  char *full_name = scope_full_name(parser->scope, name);
  struct NamedFunction *named = function_named(parser->scope, full_name);
  release(full_name);
  return named;
}

static struct Quantity parse_call(struct Parser *parser, const char *name) {
  const struct Table *table = find_table(parser, name);
  struct NamedFunction *named = find_named_function(parser, name);
  if (table != NULL) return parse_table(parser, table, name);
  if (named != NULL) return parse_function_call(parser, named);
  if (strcmp(name, "sum") == 0) return parse_repeated_sum(parser);
  if (strcmp(name, "der") == 0) return parse_derivative(parser);
  if (strcmp(name, "diff") == 0) return parse_partial_derivative(parser);
  if (strcmp(name, "integral") == 0) return parse_integral(parser);
  if (strcmp(name, "if") == 0) return parse_choice(parser);
  if (is_rounding(name)) return parse_rounding(parser, name);
  if (strcmp(name, "gauss") == 0 || strcmp(name, "uniform") == 0) return parse_random(parser, name);
  if (is_function_of_vectors(name)) return parse_function_of_vectors(parser, name);
  bool is_root = strcmp(name, "sqrt") == 0;
  enum Operation operation = is_root ? POWER : find_function(name);
  if (operation == OPERATION_COUNT) {
    report_unknown_function(parser, name);
    return nothing;
  }
  struct Quantity a, b;
  parse_operands(parser, name, is_root ? 1 : operation_arity(operation), &a, &b);
  if (parser->failed) return nothing;
  if (is_root) b = (struct Quantity){.node = graph_constant(parser->graph, 0.5), .dimension = dimension_one};
  return operation == POWER ? quantity_power(parser, a, b) : quantity_function(parser, operation, a, b);
}

static void require_limits(struct Parser *parser) {
  const char *limit = graph_limit(parser->graph);
  if (limit == NULL) return;
  if (parser->scope->diagnostics->errors > 0) parser->failed = true; /* the limit has been reported */
  else
    FAIL(parser, "%s: the system is too large: %s; expected fewer or shorter repetitions", parser->location.what,
         limit);
}

static struct Quantity parse_parentheses(struct Parser *parser) {
  parser->next++;
  struct Quantity value = parse_sum(parser);
  expect_character(parser, ')', "to close a parenthesis");
  return value;
}

/* Parses a variable or a call. Only names of tables and <function>s may have an index or a prefix in a call. */
static struct Quantity parse_named(struct Parser *parser) {
  char *name = read_identifier(parser);
  const char *end = parser->next; /* errors about the name are reported on its line */
  if (accept_character(parser, '(')) return parse_call(parser, name);
  parser->next = end;
  name = read_name_suffix(parser, name);
  end = parser->next;
  if (parser->failed) return nothing;
  bool is_callable = find_table(parser, name) != NULL || find_named_function(parser, name) != NULL;
  if (is_callable && accept_character(parser, '(')) return parse_call(parser, name);
  parser->next = end;
  return look_up(parser, name);
}

static struct Quantity parse_primary(struct Parser *parser) {
  char buffer[32];
  graph_work(parser->graph, PRIMARY_WORK);
  require_limits(parser);
  if (parser->failed) return nothing;
  skip_space(parser);
  char c = *parser->next;
  if (isdigit((unsigned char)c) || (c == '.' && isdigit((unsigned char)parser->next[1]))) return parse_literal(parser);
  if (c == '(') return parse_parentheses(parser);
  if (isalpha((unsigned char)c) || c == '_') return parse_named(parser);
  FAIL(parser, "%s: expected a number, a name or '(', found %s%s", parser->location.what, found(parser, buffer),
       hint_for_text(parser->text, parser->next));
  return nothing;
}

struct Quantity parse_power(struct Parser *parser) {
  struct Quantity base = parse_primary(parser);
  if (parser->failed || !accept_character(parser, '^')) return base;
  enter(parser);
  struct Quantity exponent = parser->failed ? nothing : parse_sign(parser);
  parser->nesting--;
  return parser->failed ? nothing : quantity_power(parser, base, exponent);
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
    bool is_product = accept_character(parser, '*');
    if (!is_product && !accept_character(parser, '/')) break;
    struct Quantity factor = parse_sign(parser);
    if (parser->failed) break;
    value = (is_product ? quantity_multiply : quantity_divide)(parser, value, factor);
  }
  return value;
}

struct Quantity parse_sum(struct Parser *parser) {
  enter(parser);
  if (parser->failed) return nothing;
  struct Quantity value = parse_term(parser);
  while (!parser->failed) {
    bool is_plus = accept_character(parser, '+');
    if (!is_plus && !accept_character(parser, '-')) break;
    struct Quantity term = parse_term(parser);
    if (parser->failed) break;
    value = (is_plus ? quantity_add : quantity_subtract)(parser, value, term);
  }
  parser->nesting--;
  return value;
}

static struct Parser parser_of(struct Scope *scope, const char *text, struct Location location) {
  scope->graph->not_finite = false;
  return (struct Parser){
      .scope = scope, .graph = scope->graph, .location = location, .text = text, .next = text, .counted = text};
}

struct Quantity parse_whole_text(struct Parser *parser, struct Quantity (*read)(struct Parser *parser)) {
  char buffer[32];
  struct Quantity value = read(parser);
  skip_space(parser);
  if (!parser->failed && *parser->next == ')')
    FAIL(parser, "%s: ')' without '('; expected an operator or the end", parser->location.what);
  if (!parser->failed && *parser->next != '\0')
    FAIL(parser, "%s: expected an operator or the end, found %s%s", parser->location.what, found(parser, buffer),
         hint_for_text(parser->text, parser->next));
  require_limits(parser);
  return parser->failed ? nothing : value;
}

/* Parses the text by the function `read`. Returns false after an error; the value is then 0. */
static bool read_text(struct Scope *scope, const char *text, struct Location location,
                      struct Quantity (*read)(struct Parser *parser), struct Quantity *value) {
  struct Parser parser = parser_of(scope, text, location);
  *value = parse_whole_text(&parser, read);
  return !parser.failed;
}

struct Quantity parse_expression(struct Scope *scope, const char *text, struct Location location) {
  struct Quantity value;
  read_text(scope, text, location, parse_sum, &value);
  return value;
}

static struct Quantity condition_as_quantity(struct Parser *parser) {
  return (struct Quantity){.node = parse_condition(parser)};
}

/*
 * True if a node is a truth value that is constant between events. It is a mode other than the sign of an
 * expression, a state of contacts or frictions, or if(...).
 */
static bool is_truth(const struct Scope *scope, const char *text, Node node) {
  if (!graph_is_constant_in_time(scope->graph, node)) return false;
  bool is_choice = strncmp(text + strspn(text, " \t\r\n"), "if", 2) == 0 && graph_depends_on(scope->graph, node, MODE);
  bool is_mode = scope->graph->vertices[node].operation == SYMBOL && graph_depends_on(scope->graph, node, MODE) &&
                 branch_with_mode(scope->switches, node) == NULL;
  return is_choice || is_mode || (deciding_kinds(scope, node) & CONTACT_STATE) != 0;
}

bool parse_when(struct Scope *scope, const char *text, struct Location location, Node *value) {
  bool compares = is_condition(text);
  struct Quantity quantity;
  bool is_right = read_text(scope, text, location, compares ? condition_as_quantity : parse_sum, &quantity);
  *value = is_right ? quantity.node : ZERO;
  if (!is_right || compares) return is_right;
  return is_truth(scope, text, *value);
}

bool parse_constant(struct Scope *scope, const char *text, struct Location location, struct Quantity *value) {
  location.kinds = 0;
  return read_text(scope, text, location, parse_sum, value);
}

bool parse_number(struct Scope *scope, const char *text, struct Location location, double *value) {
  struct Quantity quantity;
  if (!parse_constant(scope, text, location, &quantity)) return false;
  *value = graph_value(scope->graph, quantity.node);
  return true;
}

char *parse_name(struct Scope *scope, const char *text, struct Location location, bool parts) {
  struct Parser parser = parser_of(scope, text, location);
  char *name = NULL;
  if (isalpha((unsigned char)*text) || *text == '_') name = read_name_suffix(&parser, read_identifier(&parser));
  if (name == NULL || *parser.next != '\0' || (!parts && strchr(name, '.') != NULL))
    FAIL(&parser, "%s: '%s' is not a name; expected letters, digits and _, or name[index]%s", location.what, text,
         parts ? ", also of an included system, as in motor.theta" : "");
  return parser.failed ? NULL : name;
}
