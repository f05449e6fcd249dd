#include "read/expressions/named_functions.h"

#include <string.h>

#include "base/memory.h"
#include "read/expressions/number_units.h"
#include "read/expressions/parser.h"

/* Units of work charged for each call. They bound the time that nested calls take. */
enum { CALL_WORK = 1000 };

struct NamedFunction *function_named(const struct Scope *scope, const char *full_name) {
  return names_find(scope->functions, full_name);
}

static char *list_arguments(const struct NamedFunction *function) {
  char *list = copy_text("");
  for (size_t i = 0; i < function->argument_count; i++)
    list = format_text("%s%s%s", list, i > 0 ? ", " : "", function->arguments[i]);
  return list;
}

/* Parses the arguments of a call as local names. Returns the innermost one, which is the last; NULL after an error. */
static struct Local *parse_arguments(struct Parser *parser, const struct NamedFunction *function) {
  struct Local *locals = allocate(function->argument_count, sizeof *locals);
  size_t count = 0;
  do {
    struct Quantity value = parse_sum(parser);
    if (value.literal)
      value.dimension = dimension_unknown; /* adopts the unit of the other operand, only in the expression */
    value.literal = false;
    if (count < function->argument_count)
      locals[count] = (struct Local){function->arguments[count], value, count > 0 ? &locals[count - 1] : NULL};
    count++;
  } while (!parser->failed && accept_character(parser, ','));
  expect_character(parser, ')', format_text("after the arguments of %s", function->name));
  if (count != function->argument_count)
    FAIL(parser, "%s: the function '%s' has %zu argument%s; expected %zu, as in %s(%s)", parser->location.what,
         function->name, count, count == 1 ? "" : "s", function->argument_count, function->name,
         list_arguments(function));
  return parser->failed ? NULL : &locals[count - 1];
}

/* Appends the indices of each <for> around the definition, in the function's own file, as outermost local names. */
static struct Local *add_indices(struct Parser *parser, const struct NamedFunction *function, struct Local *locals) {
  size_t length = strlen(function->prefix);
  for (const struct Loop *loop = function->loop; loop != NULL; loop = loop->outer) {
    if (strncmp(loop->index, function->prefix, length) != 0) continue;
    struct Local *index = allocate(1, sizeof *index);
    struct Quantity value = {
        .node = graph_constant(parser->graph, loop->value), .dimension = dimension_one, .literal = true};
    *index = (struct Local){loop->index + length, value, NULL};
    struct Local *last = locals;
    while (last->outer != NULL) last = last->outer;
    last->outer = index;
  }
  return locals;
}

/* Reports direct or indirect recursion. */
static void check_recursion(struct Parser *parser, const struct NamedFunction *function) {
  const struct Parser *first = parser;
  while (first->function != NULL && first->function != function) first = first->caller;
  if (first->function == NULL) return;
  char *circle = copy_text(function->name);
  for (const struct Parser *caller = parser; caller != first->caller; caller = caller->caller)
    circle = format_text("%s -> %s", caller->function->name, circle);
  FAIL(parser, "%s: functions call each other in a circle: %s; expected one that does not call the next",
       parser->location.what, circle);
}

static void require_value_unit(struct Parser *parser, const struct NamedFunction *function, struct Quantity *value) {
  if (!function->value.known || parser->failed) return;
  if (!value->literal && !scope_units_agree(parser->scope, value->dimension, function->value)) {
    char *problem =
        format_text("%s: unit mismatch: the value of '%s' has the unit %s, expected %s", parser->location.what,
                    function->name, unit_text(value->dimension), unit_text(function->value));
    if (!number_may_have_unit(parser->scope, current_line(parser), *value, function->value, problem))
      FAIL(parser, "%s", problem);
  }
  *value = (struct Quantity){.node = value->node, .dimension = function->value};
}

/* Returns the subject of messages about the expression: the outermost call with its line, and the function. */
static const char *name_of_use(struct Parser *parser, const struct NamedFunction *function) {
  if (parser->function != NULL) return format_text("%s '%s'", parser->use, function->name);
  parser->use = format_text("%s of line %ld, in the function", parser->location.what, current_line(parser));
  return format_text("%s '%s'", parser->use, function->name);
}

/* Parses the function's expression in the context of the file that defines it. */
static struct Quantity read_expression(struct Parser *parser, const struct NamedFunction *function,
                                       struct Local *locals) {
  struct Scope *scope = parser->scope;
  const char *file = scope->diagnostics->file, *origin = scope->diagnostics->origin, *prefix = scope->prefix;
  struct Parser inner = *parser;
  inner.location.what = name_of_use(parser, function);
  inner.use = parser->use;
  inner.location.line = function->line;
  inner.text = inner.next = inner.counted = function->text;
  inner.newlines = 0;
  inner.locals = locals;
  inner.function = function;
  inner.caller = parser;
  scope->diagnostics->file = function->file;
  scope->diagnostics->origin = function->origin;
  scope->prefix = function->prefix;
  struct Quantity value = parse_whole_text(&inner, parse_sum);
  require_value_unit(&inner, function, &value);
  scope->diagnostics->file = file;
  scope->diagnostics->origin = origin;
  scope->prefix = prefix;
  parser->failed = inner.failed;
  parser->repetitions = inner.repetitions;
  return value;
}

struct Quantity parse_function_call(struct Parser *parser, struct NamedFunction *function) {
  static const struct Quantity nothing = {.node = ZERO};
  function->is_used = true;
  graph_work(parser->graph, CALL_WORK);
  struct Local *locals = parse_arguments(parser, function);
  check_recursion(parser, function);
  if (parser->failed) return nothing;
  struct Quantity value = read_expression(parser, function, add_indices(parser, function, locals));
  return parser->failed ? nothing : value;
}
