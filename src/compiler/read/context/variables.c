#include "read/context/variables.h"

#include <math.h>

#include "base/memory.h"

struct Variable *append_variable(struct VariableList *list, struct Variable variable) {
  list->items = reallocate(list->items, list->count + 1, sizeof *list->items);
  list->items[list->count] = variable;
  return &list->items[list->count++];
}

struct Variable common_attributes(struct Reader *reader, xmlNodePtr node) {
  struct Variable variable = {.name = name_attribute(reader, node, "name"),
                              .description = attribute(node, "description"),
                              .unit = attribute(node, "unit"),
                              .dimension = unit_attribute(reader, node, "unit"),
                              .start = NAN,
                              .minimum = NAN,
                              .maximum = NAN,
                              .nominal = NAN,
                              .line = xmlGetLineNo(node)};
  if (variable.name == NULL) variable.name = copy_text("?"); /* reported already */
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
