#include "read/expressions/cursor.h"

#include <ctype.h>
#include <string.h>

#include "base/memory.h"
#include "names/hints.h"

long current_line(struct Parser *parser) {
  for (; parser->counted < parser->next; parser->counted++) parser->newlines += *parser->counted == '\n';
  while (parser->counted > parser->next) parser->newlines -= *--parser->counted == '\n';
  return parser->location.line + parser->newlines;
}

/* Functions cannot use the indices of a <for> around the calling expression. */
const struct Quantity *find_quantity(const struct Parser *parser, const char *name) {
  for (const struct Local *local = parser->locals; local != NULL; local = local->outer)
    if (strcmp(local->name, name) == 0) return &local->value;
  char *full_name = scope_full_name(parser->scope, name);
  bool is_hidden = parser->function != NULL && scope_is_index(parser->scope, full_name);
  const struct Quantity *quantity = is_hidden ? NULL : scope_find(parser->scope, full_name);
  release(full_name);
  return quantity;
}

void skip_space(struct Parser *parser) {
  while (isspace((unsigned char)*parser->next)) parser->next++;
}

const char *found(const struct Parser *parser, char buffer[32]) {
  if (*parser->next == '\0') return "the end";
  size_t length = 1;
  if (isalnum((unsigned char)*parser->next))
    while (length < 24 && isalnum((unsigned char)parser->next[length])) length++;
  else
    while (length < 4 && ((unsigned char)parser->next[length] & 0xC0u) == 0x80u) length++;
  snprintf(buffer, 32, "'%.*s'", (int)length, parser->next);
  return buffer;
}

bool accept_character(struct Parser *parser, char c) {
  skip_space(parser);
  if (*parser->next != c) return false;
  parser->next++;
  return true;
}

void expect_character(struct Parser *parser, char c, const char *context) {
  char buffer[32];
  if (parser->failed || accept_character(parser, c)) return;
  FAIL(parser, "%s: expected '%c' %s, found %s%s", parser->location.what, c, context, found(parser, buffer),
       c == ']' ? "" : hint_for_text(parser->text, parser->next));
}
