#include "read/elements/parameters.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "read/context/variables.h"
#include "read/elements/named_expressions.h"

static const char *const type_names[] = {[TYPE_REAL] = "Real", [TYPE_INTEGER] = "Integer", [TYPE_BOOLEAN] = "Boolean"};

static enum VariableType type_of(xmlNodePtr node) {
  char *text = attribute(node, "type");
  enum VariableType type = TYPE_BOOLEAN;
  while (text != NULL && type > TYPE_REAL && strcmp(text, type_names[type]) != 0) type--;
  if (text == NULL) type = TYPE_REAL;
  return type;
}

/* Reports attributes of settable parameters in an element that has a value, or in an override. */
static void check_value_alone(struct Reader *reader, xmlNodePtr node) {
  static const char *const others[] = {"start", "min", "max", "type"};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (has_attribute(node, others[i]))
      report_at(reader, node,
                "a <%s> has a value and a %s; expected value=\"...\" alone for one that follows from "
                "others, or start=\"...\" for one that is set",
                (const char *)node->name, others[i]);
}

/*
 * An override with a value replaces start, min and max of the file and of inner <include>s. Beside the value and in
 * outer <include>s they are errors.
 */
void check_calculated(struct Reader *reader, const struct Override *overrides, xmlNodePtr node) {
  const struct Override *override = override_of_value(overrides), *inner = override != NULL ? override->inner : NULL;
  for (; overrides != inner; overrides = overrides->inner) {
    struct Source *present = source_enter(reader, overrides->source);
    check_value_alone(reader, overrides->node);
    source_enter(reader, present);
  }
  if (override == NULL) check_value_alone(reader, node);
}

static bool is_whole(double number) {
  return number == floor(number) && fabs(number) <= INT_MAX;
}

static void check_type(struct Reader *reader, const struct Variable *variable) {
  struct Diagnostics *diagnostics = reader->diagnostics;
  const char *type = type_names[variable->type];
  if (variable->type == TYPE_REAL) return;
  if (variable->unit != NULL && strcmp(variable->unit, "1") != 0)
    report_error(diagnostics, variable->line, "'%s' has a unit and type=\"%s\", which has none; expected type=\"Real\"",
                 variable->name, type);
  const double numbers[] = {variable->start, variable->minimum, variable->maximum};
  for (size_t i = 0; i < 3 && variable->type == TYPE_INTEGER; i++)
    if (!isnan(numbers[i]) && !is_whole(numbers[i]))
      report_error(diagnostics, variable->line,
                   "'%s': %g is not an Integer; expected a whole number of at most 9 digits", variable->name,
                   numbers[i]);
  if (variable->type != TYPE_BOOLEAN) return;
  if (variable->start != 0.0 && variable->start != 1.0)
    report_error(diagnostics, variable->line, "'%s': %g is not a Boolean; expected true or false", variable->name,
                 variable->start);
  if (!isnan(variable->minimum) || !isnan(variable->maximum))
    report_error(diagnostics, variable->line, "'%s': a Boolean has neither min nor max; expected none", variable->name);
}

/* Sets the start value to a number, or to true or false. */
static void read_value(struct Reader *reader, xmlNodePtr node, const char *name, const char *text,
                       struct Variable *variable) {
  bool is_true = strcmp(text, "true") == 0, is_false = strcmp(text, "false") == 0;
  if (variable->type == TYPE_BOOLEAN && (is_true || is_false)) variable->start = is_true ? 1.0 : 0.0;
  else if (variable->type == TYPE_BOOLEAN && (strcasecmp(text, "true") == 0 || strcasecmp(text, "false") == 0))
    report_at(reader, node, "'%s' is not in small letters; expected %s", text,
              strcasecmp(text, "true") == 0 ? "true" : "false");
  else if (!number_in(reader, node, name, text, &variable->start)) variable->start = 0.0;
}

/* Reads the start value from an override or from the element's attribute. */
static void read_start(struct Reader *reader, xmlNodePtr node, const struct Override *overrides,
                       struct Variable *variable) {
  struct Source *present = enter_override(reader, override_of_attribute(overrides, "start"), &node);
  char *text = attribute(node, "start");
  if (text != NULL) read_value(reader, node, "start", text, variable);
  source_enter(reader, present);
}

static struct Variable variable_of(struct Reader *reader, xmlNodePtr node) {
  struct Variable variable = common_attributes(reader, node);
  variable.type = type_of(node);
  if (variable.type != TYPE_REAL) variable.dimension = unit_of("1");
  return variable;
}

/* Declares a parameter whose start value has been read. The range may be overridden. */
static void declare(struct Reader *reader, xmlNodePtr node, const struct Override *overrides,
                    struct Variable variable) {
  struct VariableList *list = &reader->model->parameters;
  overridden_number_attribute(reader, node, overrides, "min", &variable.minimum);
  overridden_number_attribute(reader, node, overrides, "max", &variable.maximum);
  check_range(reader, &variable);
  check_type(reader, &variable);
  variable.node =
      scope_symbol(reader->scope, PARAMETER, (int)list->count, variable.name, variable.dimension, variable.line);
  variable.line = scope_line(reader->scope, variable.line);
  append_variable(list, variable);
}

/* Declares the parameter for one value of a list. */
static void read_listed(struct Reader *reader, xmlNodePtr node, char *name, const char *text) {
  struct Variable variable = variable_of(reader, node);
  variable.name = name;
  const struct Override *overrides = overrides_of(reader, node, name);
  if (override_of_value(overrides) != NULL)
    report_at(reader, node,
              "'%s' is one of a list of values, to which an <include> can give a start; expected start in place of "
              "value",
              name);
  read_value(reader, node, "values", text, &variable);
  read_start(reader, node, overrides, &variable);
  declare(reader, node, overrides, variable);
}

void check_name_of_list(struct Reader *reader, xmlNodePtr node, const char *name) {
  if (strchr(name, ']') != NULL && name[strlen(name) - 1] == ']')
    report_at(reader, node,
              "the %s '%s' with values has an index; expected a name alone, which gets the indices 1, 2, ...",
              (const char *)node->name, name);
}

/* Declares m[1], m[2] and m[3] for values="1 2 3" of m. */
static void read_list(struct Reader *reader, xmlNodePtr node) {
  const char *next = attribute(node, "values"), *name = name_attribute(reader, node, "name");
  if (has_attribute(node, "start") || has_attribute(node, "value"))
    report_at(reader, node, "a <parameter> has values and a start or value; expected values=\"...\" alone");
  if (name == NULL) return;
  check_name_of_list(reader, node, name);
  size_t count = 0;
  for (char *text = next_listed(&next); text != NULL; text = next_listed(&next))
    read_listed(reader, node, format_text("%s[%zu]", name, ++count), text);
  if (count == 0) report_at(reader, node, "the parameter '%s' has no values; expected numbers", name);
}

void read_parameter(struct Reader *reader, xmlNodePtr node) {
  if (has_attribute(node, "values")) {
    read_list(reader, node);
    return;
  }
  struct Variable variable = variable_of(reader, node);
  const struct Override *overrides = overrides_of(reader, node, variable.name);
  if (has_value(node, overrides)) {
    check_calculated(reader, overrides, node);
    return;
  }
  variable.start = 0.0;
  read_start(reader, node, overrides, &variable);
  declare(reader, node, overrides, variable);
  if (!has_attribute(node, "start") && override_of_attribute(overrides, "start") == NULL)
    report_at(reader, node,
              "<parameter> needs the attribute 'start'; expected start=\"...\", value=\"...\" for one that "
              "follows from others, or values=\"...\" for name[1], name[2], ...");
}
