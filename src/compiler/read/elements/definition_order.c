#include "read/elements/definition_order.h"

#include "base/memory.h"
#include "read/elements/named_expressions.h"

/* Reports a cycle as a -> b -> a. closing: the definition that begins and ends it. */
static void report_circle(const struct Definitions *definitions, struct Reader *reader, size_t top, size_t closing) {
  struct TextStream text;
  FILE *file = open_text(&text);
  bool inside = false;
  for (size_t i = 0; i <= top; i++) {
    const struct Definition *definition = &definitions->items[definitions->stack[i]];
    inside = inside || definitions->stack[i] == closing;
    if (inside && definition->state == ACTIVE) fprintf(file, "%s -> ", definition->name);
  }
  const char *names = close_text(&text);
  const struct NamedExpression *expression = &definitions->items[closing].expression;
  struct Source *present = source_enter(reader, expression->source);
  report_error(reader->diagnostics, line_of(expression->node),
               "definitions depend on each other in a circle: %s%s; expected one that does not use the next", names,
               definitions->items[closing].name);
  source_enter(reader, present);
}

/* Marks the definition at `top` as waiting for those above it. Reports a cycle if one of these waits already. */
static void keep_waiting(struct Definitions *definitions, struct Reader *reader, size_t top) {
  size_t *stack = definitions->stack, closing = 0;
  bool is_circle = false;
  definitions->items[stack[top]].state = ACTIVE;
  for (size_t i = top + 1; i < definitions->stack_count && !is_circle; i++) {
    closing = stack[i];
    is_circle = definitions->items[closing].state == ACTIVE;
  }
  if (!is_circle) return;
  report_circle(definitions, reader, top, closing);
  for (size_t i = 0; i < definitions->stack_count; i++) { /* all that wait become 0: one message per cycle */
    struct Definition *definition = &definitions->items[stack[i]];
    struct Quantity nothing = {.node = ZERO};
    if (definition->state == ACTIVE)
      scope_define(reader->scope, definition->name, nothing, line_of(definition->expression.node));
    if (definition->state == ACTIVE) definition->state = READ;
  }
}

static void read_on_stack(struct Definitions *definitions, struct Reader *reader) {
  while (definitions->stack_count > 0) {
    size_t top = definitions->stack_count - 1;
    struct Definition *definition = &definitions->items[definitions->stack[top]];
    if (definition->state >= READ) {
      definitions->stack_count--;
      continue;
    }
    struct Requirements *requirements = &reader->scope->requirements;
    size_t requirement_count = requirements->count;
    definitions->waiting = 0;
    bind_indices(reader->scope, definition->loop); /* clashes of names are reported later, see expansion.c */
    struct Quantity value = read_named_expression(reader, &definition->expression, definition->name);
    unbind_indices(reader->scope, definition->loop);
    if (definitions->waiting > 0) {
      requirements->count = requirement_count;
      definitions->waiting = 0;
      keep_waiting(definitions, reader, top);
    } else {
      xmlNodePtr node = definition->expression.node;
      struct Source *present = source_enter(reader, definition->expression.source);
      bool is_new = scope_define(reader->scope, definition->name, value, line_of(node));
      if (is_new) keep_named_expression(reader, node, definition->name, value);
      source_enter(reader, present);
      definition->state = READ;
    }
  }
}

/* Parses an output while another element is read, whose indices and attributes of parsing do not hold in it. */
static void parse_output(void *context, size_t number) {
  struct Reader *reader = context;
  struct Scope *scope = reader->scope;
  const struct Loop *loops = reader->definitions->present;
  bool keeps_whole = scope->keeps_whole;
  unbind_indices(scope, loops);
  scope->keeps_whole = false;
  definitions_push(reader->definitions, number);
  read_on_stack(reader->definitions, reader);
  scope->keeps_whole = keeps_whole;
  bind_indices(scope, loops);
}

void resolve_definitions(struct Reader *reader) {
  struct Definitions *definitions = reader->definitions;
  definitions->parse = parse_output;
  definitions->reader = reader;
  for (size_t i = 0; i < definitions->count && graph_limit(reader->model->graph) == NULL; i++) {
    if (definitions->items[i].state >= READ || is_element(definitions->items[i].expression.node, "output")) continue;
    definitions_push(definitions, i);
    read_on_stack(definitions, reader);
  }
}
