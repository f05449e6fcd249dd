#include "read/context/variables.h"

#include "algebra/units/other_units.h"
#include "base/memory.h"

struct Variable *append_variable(struct VariableList *list, struct Variable variable) {
  APPEND(list->items, list->count, variable);
  return &list->items[list->count - 1];
}

Node append_input(struct Reader *reader, struct Variable variable) {
  struct Model *model = reader->model;
  size_t index = model->inputs.count;
  variable.node = scope_symbol(reader->scope, INPUT, (int)index, variable.name, variable.dimension, variable.line);
  variable.line = scope_line(reader->scope, variable.line);
  model->prescribed.input_rates =
      make_room(model->prescribed.input_rates, index, sizeof *model->prescribed.input_rates);
  model->prescribed.input_rates[index] = ZERO;
  append_variable(&model->inputs, variable);
  return variable.node;
}

/* True if both dimensions are equal and known. Angles count here: rpm is no unit for Hz. */
static bool is_same_dimension(struct Dimension first, struct Dimension second) {
  for (int i = 0; i < BASE_UNIT_COUNT; i++)
    if (first.exponent[i] != second.exponent[i]) return false;
  return first.known && second.known;
}

char *display_unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name, struct Dimension dimension) {
  struct Dimension shown;
  struct UnitScale scale;
  char *text = attribute(node, name);
  if (text == NULL) return NULL;
  if (!display_unit_parse(text, &shown, &scale))
    report_error(reader->diagnostics, line_of(node),
                 "%s '%s' is not known; expected a unit that is not SI, such as deg, rpm, deg/s, mm, kN or degC", name,
                 text);
  else if (!is_same_dimension(shown, dimension))
    report_error(reader->diagnostics, line_of(node), "%s '%s' is for values in %s; expected this as the unit", name,
                 text, unit_text(shown));
  else return text;
  return NULL;
}

struct Variable common_attributes(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) name = copy_text("?"); /* the error has been reported */
  struct Variable variable = variable_create(name, attribute(node, "description"), line_of(node));
  variable.unit = attribute(node, "unit");
  variable.dimension = unit_attribute(reader, node, "unit");
  variable.display_unit = display_unit_attribute(reader, node, "displayUnit", variable.dimension);
  return variable;
}

void check_range(struct Reader *reader, const struct Variable *variable) {
  if (variable->minimum > variable->maximum)
    report_error(reader->diagnostics, variable->line,
                 "'%s': min %g is larger than max %g; expected the smaller number as min", variable->name,
                 variable->minimum, variable->maximum);
  else if (variable->start < variable->minimum || variable->start > variable->maximum)
    report_error(reader->diagnostics, variable->line,
                 "'%s': start %g is outside min and max; expected a start between them", variable->name,
                 variable->start);
}
