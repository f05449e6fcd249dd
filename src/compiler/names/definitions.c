#include "names/definitions.h"

#include <string.h>

#include "base/memory.h"
#include "names/scope.h"

struct Definitions *definitions_create(void) {
  struct Definitions *definitions = allocate(1, sizeof *definitions);
  definitions->numbers = names_create();
  return definitions;
}

void definitions_enter(struct Definitions *definitions, struct Loop loop) {
  struct Loop *own = allocate(1, sizeof *own);
  *own = loop;
  own->outer = definitions->present;
  definitions->present = own;
}

void definitions_leave(struct Definitions *definitions) {
  definitions->present = definitions->present->outer;
}

void bind_indices(struct Scope *scope, const struct Loop *loop) {
  for (; loop != NULL; loop = loop->outer)
    if (scope_find(scope, loop->index) == NULL) scope_set_index(scope, loop->index, loop->value);
}

void unbind_indices(struct Scope *scope, const struct Loop *loop) {
  for (; loop != NULL; loop = loop->outer) scope_remove_index(scope, loop->index);
}

void definitions_add(struct Definitions *definitions, char *name, const struct NamedExpression *expression) {
  definitions->items = make_room(definitions->items, definitions->count, sizeof *definitions->items);
  if (names_find(definitions->numbers, name) == NULL) {
    size_t *number = allocate(1, sizeof *number);
    *number = definitions->count;
    names_set(definitions->numbers, name, number);
  }
  definitions->items[definitions->count++] = (struct Definition){name, *expression, definitions->present, UNREAD};
}

void definitions_push(struct Definitions *definitions, size_t number) {
  APPEND(definitions->stack, definitions->stack_count, number);
}

bool definitions_wait_for(struct Definitions *definitions, const char *name) {
  const size_t *number = definitions != NULL ? names_find(definitions->numbers, name) : NULL;
  if (number == NULL || definitions->stack_count == 0 || definitions->items[*number].state >= READ) return false;
  definitions_push(definitions, *number);
  definitions->waiting++;
  return true;
}

bool definitions_parse_now(struct Definitions *definitions, const char *name) {
  const size_t *number = definitions != NULL ? names_find(definitions->numbers, name) : NULL;
  if (number == NULL || definitions->stack_count > 0 || definitions->items[*number].state >= READ) return false;
  definitions->parse(definitions->reader, *number);
  return true;
}

bool definitions_take(struct Definitions *definitions, const char *name, const xmlNode *node) {
  const size_t *number = names_find(definitions->numbers, name);
  struct Definition *definition = number != NULL ? &definitions->items[*number] : NULL;
  bool is_parsed = definition != NULL && definition->expression.node == node && definition->state == READ;
  if (definition != NULL && definition->expression.node == node) definition->state = TAKEN;
  return is_parsed;
}

bool definitions_contain(const struct Definitions *definitions, const char *name) {
  return definitions != NULL && names_find(definitions->numbers, name) != NULL;
}

bool definitions_are_waiting(const struct Definitions *definitions) {
  return definitions != NULL && definitions->waiting > 0;
}
