#include "read/context/variables.h"

#include "base/memory.h"

struct Variable *append_variable(struct VariableList *list, struct Variable variable) {
  list->items = make_room(list->items, list->count, sizeof *list->items);
  list->items[list->count] = variable;
  return &list->items[list->count++];
}

struct Variable common_attributes(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) name = copy_text("?"); /* reported already */
  struct Variable variable = variable_create(name, attribute(node, "description"), xmlGetLineNo(node));
  variable.unit = attribute(node, "unit");
  variable.dimension = unit_attribute(reader, node, "unit");
  return variable;
}

void check_range(struct Reader *reader, const struct Variable *variable) {
  if (variable->minimum > variable->maximum)
    report_error(reader->diagnostics, variable->line, "'%s': min %g is larger than max %g", variable->name,
                 variable->minimum, variable->maximum);
  else if (variable->start < variable->minimum || variable->start > variable->maximum)
    report_error(reader->diagnostics, variable->line, "'%s': start %g is outside min and max", variable->name,
                 variable->start);
}
