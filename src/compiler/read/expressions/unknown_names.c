#include "read/expressions/constructs.h"

#include <string.h>

#include "algebra/functions.h"
#include "base/memory.h"
#include "read/expressions/named_functions.h"
#include "names/definitions.h"
#include "names/hints.h"
#include "names/similar.h"
#include "names/words.h"
#include "read/tables/table.h"

/* Returns the kinds of names that are allowed here, for messages. */
static const char *expected_names(const struct Parser *parser) {
  if (parser->location.kinds == 1u << PARAMETER) return "a parameter or a constant";
  if (parser->scope->model == NULL) return "a number, perhaps with its unit, such as 0.5, pi/2 or 30deg";
  return parser->location.kinds == 0 ? "a number, or a constant that is defined above"
                                     : "a parameter, coordinate, velocity, state, mode, input, definition or time";
}

static bool is_known(const struct Parser *parser, const char *name) {
  char *full_name = scope_full_name(parser->scope, name);
  return scope_find(parser->scope, full_name) != NULL || definitions_contain(parser->scope->definitions, full_name);
}

/* Returns the known components of a point, body or frame, such as "bob.x or bob.y"; "" if there are none. */
static char *components_of(const struct Parser *parser, const char *body, size_t length) {
  static const char *const components[] = {"x",      "y",      "z",  "angle",  "vx",     "vy",     "vz",
                                           "ax",     "ay",     "az", "omegaX", "omegaY", "omegaZ", "alphaX",
                                           "alphaY", "alphaZ", "wx", "wy",     "wz",     "R11",    "R33"};
  char *list = copy_text("");
  for (size_t i = 0; i < sizeof components / sizeof *components; i++) {
    char *name = format_text("%.*s.%s", (int)length, body, components[i]);
    if (is_known(parser, name)) list = format_text("%s%s%s", list, *list != '\0' ? " or " : "", name);
  }
  return list;
}

/* Returns the name of an item of a list, such as c[2].force of the list c and the ending .force. */
static char *item_of(const char *list, int index, const char *ending) {
  return format_text("%s[%d]%s", list, index, ending);
}

/* Reports a name of a list without an index, or with a wrong one. False if the list has no such items. */
static bool report_item(struct Parser *parser, const char *name, const char *list, const char *ending) {
  enum { LIMIT = 1000 };
  int last = 0, first = is_known(parser, item_of(list, 0, ending)) ? 0 : 1;
  while (last < LIMIT && is_known(parser, item_of(list, last + 1, ending))) last++;
  char *whole = strchr(name, '[') == NULL ? format_text(", or sum(i, %d, %d, %s[i]%s)", first, last, list, ending) : "";
  if (last > 0)
    FAIL(parser, "%s: unknown name '%s'; expected %s, ..., %s%s", parser->location.what, name,
         item_of(list, first, ending), item_of(list, last, ending), whole);
  return last > 0;
}

/* Does so for each part of the name that may be a list: before an index, or before a dot or the end. */
static bool report_index(struct Parser *parser, const char *name) {
  const char *bracket = strchr(name, '['), *behind = strchr(name, ']');
  if (bracket != NULL && behind != NULL)
    return report_item(parser, name, format_text("%.*s", (int)(bracket - name), name), behind + 1);
  for (const char *end = name + strlen(name); end > name; end--)
    if ((*end == '\0' || *end == '.') && report_item(parser, name, format_text("%.*s", (int)(end - name), name), end))
      return true;
  return false;
}

void report_unknown_name(struct Parser *parser, const char *name) {
  /* Messages beyond ERROR_LIMIT are not printed, so that they need no search through all names. */
  bool shown = parser->scope->diagnostics->errors < ERROR_LIMIT;
  const char *similar = shown ? scope_similar_name(parser->scope, name) : NULL, *hint = hint_for_name(name);
  const char *point = strrchr(name, '.');
  char *components = components_of(parser, name, point != NULL ? (size_t)(point - name) : strlen(name));
  const char *next = parser->next + strspn(parser->next, " \t\r\n");
  if (*hint == '\0' && *next == '=') hint = hint_for_text(parser->text, next);
  if (*components != '\0')
    FAIL(parser, "%s: unknown name '%s'; expected %s, and der(...) of it for a velocity", parser->location.what, name,
         components);
  else if (*hint != '\0') FAIL(parser, "%s: unknown name '%s'%s", parser->location.what, name, hint);
  else if (shown && report_index(parser, name)) return;
  else if (similar != NULL)
    FAIL(parser, "%s: unknown name '%s'; did you mean '%s'?", parser->location.what, name, similar);
  else FAIL(parser, "%s: unknown name '%s'; expected %s", parser->location.what, name, expected_names(parser));
}

void report_reserved(struct Parser *parser, const char *name) {
  char *full_name = scope_full_name(parser->scope, name);
  bool is_table = table_named(parser->scope, full_name) != NULL;
  bool is_function = function_named(parser->scope, full_name) != NULL || is_function_name(name);
  char *force = format_text("%s.force", full_name);
  bool is_constraint = scope_find(parser->scope, force) != NULL;
  if (is_constraint)
    FAIL(parser, "%s: '%s' is a constraint, whose value is 0; expected %s.force for its force", parser->location.what,
         name, name);
  else if (is_table || is_function)
    FAIL(parser, "%s: '%s' is not a variable but a %s; expected its argument in parentheses, as in %s(...)",
         parser->location.what, name, is_table ? "table" : "function", name);
  else
    FAIL(parser, "%s: '%s' is not a variable but a result, which expressions cannot use; expected %s",
         parser->location.what, name, expected_names(parser));
}

/* Lists the functions: those of the graph, with one argument first, then those that the parser expands. */
static char *function_names(void) {
  static const char others[] =
      "sqrt, floor, ceil, round, mod, if, der, diff, sum, integral, uniform, gauss, distance, dot or norm";
  struct TextStream names;
  FILE *file = open_text(&names);
  for (int arity = 1; arity <= 2; arity++)
    for (int operation = 0; operation < OPERATION_COUNT; operation++)
      if (!functions[operation].is_internal && operation_arity((enum Operation)operation) == arity)
        fprintf(file, "%s, ", functions[operation].name);
  fputs(others, file);
  return close_text(&names);
}

/* Considers the names of the current file, without its prefix. */
static void consider_names_of_file(struct SimilarName *similar, const struct Names *names, const char *prefix) {
  size_t length = strlen(prefix);
  for (size_t i = 0; i < names->capacity; i++) {
    const char *name = names->slots[i].text;
    if (name != NULL && strncmp(name, prefix, length) == 0) similar_consider(similar, name + length);
  }
}

void report_unknown_function(struct Parser *parser, const char *name) {
  struct SimilarName similar = {.wanted = name};
  for (size_t i = 0; special_functions[i] != NULL; i++) similar_consider(&similar, special_functions[i]);
  for (size_t i = 0; free_functions[i] != NULL; i++) similar_consider(&similar, free_functions[i]);
  for (int operation = 0; operation < OPERATION_COUNT; operation++)
    if (!functions[operation].is_internal) similar_consider(&similar, functions[operation].name);
  consider_names_of_file(&similar, parser->scope->tables, parser->scope->prefix);
  consider_names_of_file(&similar, parser->scope->functions, parser->scope->prefix);
  char *names = function_names(), *indexed = format_text("%s[1]", name);
  bool joins_conditions = strcmp(name, "and") == 0 || strcmp(name, "or") == 0;
  if (similar.best != NULL && *hint_for_function(name) == '\0')
    FAIL(parser, "%s: unknown function '%s'; did you mean '%s'?", parser->location.what, name, similar.best);
  else if (is_known(parser, name) && !joins_conditions)
    FAIL(parser, "%s: '%s' is not a function; write * for a product", parser->location.what, name);
  else if (*hint_for_function(name) != '\0')
    FAIL(parser, "%s: unknown function '%s'%s", parser->location.what, name, hint_for_function(name));
  else if (is_known(parser, indexed))
    FAIL(parser, "%s: '%s' is not a function; write %s[...] for an index", parser->location.what, name, name);
  else FAIL(parser, "%s: unknown function '%s'; expected %s", parser->location.what, name, names);
}
