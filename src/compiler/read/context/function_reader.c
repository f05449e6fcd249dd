#include "read/context/readers.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/context/includes.h"
#include "read/expressions/named_functions.h"
#include "names/definitions.h"
#include "names/words.h"

static void check_argument(struct Reader *reader, xmlNodePtr node, const struct NamedFunction *function,
                           const char *name) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_", digits[] = "0123456789";
  bool begins = strchr(letters, name[0]) != NULL;
  size_t length = strspn(name, format_text("%s%s", letters, digits));
  if (!begins || name[length] != '\0')
    report_at(reader, node, "the argument '%s' of the function '%s' is not a name; expected letters, digits and _",
              name, function->name);
  else if (is_word(name))
    report_at(reader, node,
              "the argument '%s' of the function '%s' belongs to the language itself; expected another name", name,
              function->name);
  for (size_t i = 0; i < function->argument_count; i++)
    if (strcmp(function->arguments[i], name) == 0)
      report_at(reader, node, "the function '%s' has two arguments '%s'; expected another name for one of them",
                function->name, name);
}

static void read_arguments(struct Reader *reader, xmlNodePtr node, struct NamedFunction *function) {
  const char *next = attribute(node, "arguments");
  char *name = next != NULL ? next_listed(&next) : NULL;
  for (; name != NULL; name = next_listed(&next)) {
    size_t count = function->argument_count;
    check_argument(reader, node, function, name);
    function->arguments = make_room(function->arguments, count, sizeof *function->arguments);
    function->arguments[count] = name;
    function->argument_count++;
  }
  if (function->argument_count == 0)
    report_at(
        reader, node,
        "the function '%s' has no arguments; expected arguments=\"s t\", or a <define> in place of the <function>",
        function->name);
}

void declare_function(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  struct NamedFunction *function = allocate(1, sizeof *function);
  if (name == NULL) return;
  *function = (struct NamedFunction){.name = name,
                                     .text = text_of(node),
                                     .line = line_of_content(node),
                                     .value = unit_attribute(reader, node, "unit"),
                                     .file = reader->source->file,
                                     .origin = reader->source->origin,
                                     .prefix = reader->source->prefix,
                                     .loop = reader->definitions->present};
  read_arguments(reader, node, function);
  /* A function has no value without arguments: NAN reserves its name. */
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  if (function->argument_count > 0 && scope_define(reader->scope, name, word, line_of(node)))
    names_set(reader->scope->functions, name, function);
}
