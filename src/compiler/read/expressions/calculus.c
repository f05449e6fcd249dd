#include "read/expressions/constructs.h"

#include <ctype.h>
#include <string.h>

#include "algebra/differentiate.h"
#include "base/memory.h"
#include "read/expressions/integration.h"
#include "read/expressions/parser.h"
#include "read/expressions/quantities.h"
#include "names/piecewise_functions.h"

static const struct Quantity nothing = {.node = ZERO};
static const char integral_form[] = "integral(name, from, to, expression)";
static const char derivative_form[] = "diff(expression, name)";

/* Adds a dummy variable with this range to the scope. Returns its symbol; the caller decrements dummy_count. */
static Node open_dummy(struct Parser *parser, Node low, Node high) {
  struct Scope *scope = parser->scope;
  struct DummyVariable *dummy = &scope->dummies[scope->dummy_count++];
  if (dummy->symbol == ZERO) dummy->symbol = graph_symbol(parser->graph, DUMMY, (int)scope->dummy_count, "dummy");
  *dummy = (struct DummyVariable){dummy->symbol, low, high};
  return dummy->symbol;
}

/*
 * Parses an expression with these local names, dummies among them. Piecewise functions stay whole: their modes would
 * depend on dummies, which are replaced later.
 */
static struct Quantity parse_kept_whole(struct Parser *parser, struct Local *locals) {
  struct Scope *scope = parser->scope;
  struct Local *given = parser->locals;
  bool was_whole = scope->keeps_whole;
  size_t requirements = scope->requirements.count;
  parser->locals = locals;
  scope->keeps_whole = true;
  struct Quantity value = parse_sum(parser);
  scope->keeps_whole = was_whole;
  scope->requirements.count = requirements;
  parser->locals = given;
  return value;
}

/* Parses an expression in which a name stands for a new dummy. The caller removes the dummy. */
static struct Quantity parse_with_dummy(struct Parser *parser, const char *name, struct Dimension dimension, Node low,
                                        Node high) {
  struct Local local = {name, {.node = open_dummy(parser, low, high), .dimension = dimension}, parser->locals};
  return parse_kept_whole(parser, &local);
}

static void check_nesting(struct Parser *parser) {
  if (parser->scope->dummy_count == DUMMY_LIMIT)
    FAIL(parser, "%s: integrals and derivatives are nested more than %d deep; expected fewer", parser->location.what,
         DUMMY_LIMIT);
}

/*
 * Returns the name after the expression of diff(...) and sets `end` to the text after the closing parenthesis. The
 * reading position does not move.
 */
static char *look_ahead_for_name(struct Parser *parser, const char **end) {
  char buffer[32];
  const char *begin = parser->next;
  for (int depth = 0; *parser->next != '\0' && depth >= 0 && !(depth == 0 && *parser->next == ','); parser->next++)
    depth += (*parser->next == '(') - (*parser->next == ')');
  expect_character(parser, ',', format_text("before the name of %s", derivative_form));
  skip_space(parser);
  if (!isalpha((unsigned char)*parser->next) && *parser->next != '_')
    FAIL(parser, "%s: expected a name at the end of %s, found %s", parser->location.what, derivative_form,
         found(parser, buffer));
  char *name = parser->failed ? NULL : read_name(parser);
  expect_character(parser, ')', format_text("after the name of %s", derivative_form));
  *end = parser->next;
  parser->next = begin;
  return name;
}

static const struct Local *find_local(const struct Parser *parser, const char *name) {
  const struct Local *local = parser->locals;
  while (local != NULL && strcmp(local->name, name) != 0) local = local->outer;
  return local;
}

/*
 * Parses the derivative with respect to an argument of a function or the variable of an integral. Differentiates with
 * respect to a dummy, then substitutes the value.
 */
static struct Quantity derivative_by_local(struct Parser *parser, const struct Local *local) {
  struct Scope *scope = parser->scope;
  check_nesting(parser);
  if (parser->failed) return nothing;
  struct Dimension dimension = local->value.literal ? dimension_unknown : local->value.dimension;
  Node at = local->value.node;
  struct Quantity value = parse_with_dummy(parser, local->name, dimension, at, at);
  Node symbol = scope->dummies[--scope->dummy_count].symbol;
  if (parser->failed) return nothing;
  Node derivative = substitute_symbol(parser->graph, derivative_by(parser->graph, value.node, symbol), symbol, at);
  return (struct Quantity){.node = with_modes(scope, derivative, current_line(parser)),
                           .dimension = dimension_multiply(value.dimension, dimension, -1.0)};
}

static bool is_variable(const struct Graph *graph, Node node) {
  if (graph->vertices[node].operation != SYMBOL) return false;
  enum SymbolKind kind = graph_symbol_of(graph, node)->kind;
  return kind == PARAMETER || kind == TIME || kind == COORDINATE || kind == VELOCITY || kind == STATE || kind == INPUT;
}

/* Copies the local names with dummies for values that depend on the variable. The caller removes the dummies. */
static struct Local *copy_locals(struct Parser *parser, Node variable) {
  struct Local *copies = NULL, **end = &copies;
  for (const struct Local *local = parser->locals; local != NULL && !parser->failed; local = local->outer) {
    *end = allocate(1, sizeof **end);
    **end = (struct Local){local->name, local->value, NULL};
    bool depends = derivative_by(parser->graph, local->value.node, variable) != ZERO;
    if (depends) check_nesting(parser);
    if (depends && !parser->failed) (*end)->value.node = open_dummy(parser, local->value.node, local->value.node);
    end = &(*end)->outer;
  }
  return copies;
}

/*
 * Parses the expression of diff(...) and differentiates it with respect to a variable. Arguments of the enclosing
 * function are held constant even if their values depend on the variable. So dummies replace such arguments, and the
 * values are substituted after differentiation.
 */
static Node derivative_with_constant_arguments(struct Parser *parser, Node variable, struct Dimension *dimension) {
  struct Graph *graph = parser->graph;
  struct Scope *scope = parser->scope;
  size_t first = scope->dummy_count;
  struct Local *copies = copy_locals(parser, variable);
  if (parser->failed) return ZERO;
  bool has_copies = scope->dummy_count > first;
  struct Quantity value = has_copies ? parse_kept_whole(parser, copies) : parse_sum(parser);
  *dimension = value.dimension;
  Node derivative = parser->failed ? ZERO : derivative_by(graph, value.node, variable);
  while (scope->dummy_count > first) {
    const struct DummyVariable *dummy = &scope->dummies[--scope->dummy_count];
    derivative = substitute_symbol(graph, derivative, dummy->symbol, dummy->low);
  }
  return has_copies ? with_modes(scope, derivative, current_line(parser)) : derivative;
}

/* Returns the words for a name that no derivative can be taken by. */
static const char *words_for(const struct Graph *graph, Node node) {
  bool is_symbol = graph->vertices[node].operation == SYMBOL;
  if (graph_is_constant(graph, node)) return "a constant";
  return is_symbol && graph_symbol_of(graph, node)->kind == MODE ? "a mode" : "an expression";
}

static struct Quantity derivative_by_variable(struct Parser *parser, const char *name) {
  struct Graph *graph = parser->graph;
  const struct Quantity variable = look_up(parser, name);
  if (parser->failed || definitions_are_waiting(parser->scope->definitions)) return nothing;
  if (!is_variable(graph, variable.node))
    FAIL(parser,
         "%s: diff(..., %s) is by %s; expected a coordinate, velocity, state, input, parameter, time or an "
         "argument of a <function>",
         parser->location.what, name, words_for(graph, variable.node));
  struct Dimension dimension = graph_depends_on(graph, variable.node, TIME) ? unit_of("s") : variable.dimension, unit;
  Node derivative = parser->failed ? ZERO : derivative_with_constant_arguments(parser, variable.node, &unit);
  if (parser->failed) return nothing;
  return (struct Quantity){.node = derivative, .dimension = dimension_multiply(unit, dimension, -1.0)};
}

struct Quantity parse_partial_derivative(struct Parser *parser) {
  const char *end;
  char *name = look_ahead_for_name(parser, &end);
  if (parser->failed) return nothing;
  const struct Local *local = find_local(parser, name);
  struct Quantity derivative =
      local != NULL ? derivative_by_local(parser, local) : derivative_by_variable(parser, name);
  if (definitions_are_waiting(parser->scope->definitions)) derivative = nothing;
  else expect_character(parser, ',', format_text("after the expression of %s", derivative_form));
  parser->next = end;
  return parser->failed ? nothing : derivative;
}

/* Parses the optional number of nodes; returns 0 if lagc is to choose it. */
static size_t parse_node_count(struct Parser *parser) {
  if (!accept_character(parser, ',')) return 0;
  long count = parse_whole(parser, "the number of nodes of integral(...)");
  if (!parser->failed && (count < 1 || count > QUADRATURE_LIMIT))
    FAIL(parser, "%s: integral(...) has %ld nodes; expected 1 to %d", parser->location.what, count, QUADRATURE_LIMIT);
  return parser->failed ? 0 : (size_t)count;
}

struct Quantity parse_integral(struct Parser *parser) {
  const char *begin = parser->next;
  char *name = parse_declared(parser, "variable", integral_form);
  require_new_name(parser, "variable", name, "integral");
  struct Quantity from = parse_sum(parser);
  expect_character(parser, ',', format_text("after the beginning of %s", integral_form));
  struct Quantity to = parser->failed ? nothing : parse_sum(parser);
  expect_character(parser, ',', format_text("after the end of %s", integral_form));
  check_nesting(parser);
  if (parser->failed) return nothing;
  struct Dimension dimension = quantity_add(parser, from, to).dimension; /* checks that their units agree */
  struct Quantity value = parse_with_dummy(parser, name, dimension, from.node, to.node);
  struct Integral integral = {.value = value.node, .given = parse_node_count(parser)};
  expect_character(parser, ')', format_text("at the end of %s", integral_form));
  integral.text = format_text("integral(%.*s", (int)(parser->next - begin), begin);
  bool is_ready = !parser->failed && !definitions_are_waiting(parser->scope->definitions);
  Node sum = is_ready ? integrate(parser, &integral) : ZERO;
  parser->scope->dummy_count--;
  if (parser->failed) return nothing;
  return (struct Quantity){.node = sum, .dimension = dimension_multiply(value.dimension, dimension, 1.0)};
}
