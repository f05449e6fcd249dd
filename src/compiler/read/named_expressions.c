#include "read/named_expressions.h"

#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "read/definitions.h"
#include "read/elements.h"

bool is_calculated(xmlNodePtr node) {
  return xmlStrEqual(node->name, (const xmlChar *)"parameter") && xmlHasProp(node, (const xmlChar *)"value") != NULL;
}

/* The value of a definition or a calculated parameter, in its unit where it gives one. */
static struct Quantity in_own_unit(struct Reader *reader, xmlNodePtr node, const char *what, struct Quantity value) {
  struct Dimension unit = unit_attribute(reader, node);
  require_unit(reader, xmlGetLineNo(node), what, value, unit);
  if (unit.known) value.dimension = unit;
  value.literal = value.literal && !unit.known;
  return value;
}

static struct Quantity read_component(struct Reader *reader, xmlNodePtr node, const char *component) {
  struct Quantity value = {.node = ZERO};
  bool is_angle = strcmp(component, "angle") == 0;
  expression_attribute(reader, node, component, IN_POSITION, &value);
  if (definitions_are_waiting(reader->definitions)) return value;
  require_unit(reader, xmlGetLineNo(node), is_angle ? "the angle" : component, value, unit_of(is_angle ? "rad" : "m"));
  return value;
}

struct Quantity read_named_expression(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Quantity value = {.node = ZERO};
  if (name == NULL) value = expression_text_of(reader, node, "the definition", IN_OUTPUT);
  else if (is_calculated(node)) expression_attribute(reader, node, name, IN_MASS, &value);
  else return read_component(reader, node, name);
  if (definitions_are_waiting(reader->definitions)) return value;
  return in_own_unit(reader, node, name == NULL ? "the definition" : "the value of the parameter", value);
}

void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value) {
  bool is_definition = xmlStrEqual(node->name, (const xmlChar *)"define");
  if (!is_definition && !is_calculated(node)) return;
  struct Variable variable = {.name = copy_text(name),
                              .description = attribute(node, "description"),
                              .unit = attribute(node, "unit"),
                              .dimension = value.dimension,
                              .node = without_displacements(reader, xmlGetLineNo(node), "the definition", value.node)};
  append_variable(is_definition ? &reader->model->definitions : &reader->model->calculated, variable);
}

/* Of several bodies of one name, which is reported later, the first one has the components. */
static void collect_components(struct Reader *reader, xmlNodePtr node) {
  static const char *const components[] = {"x", "y", "z", "angle"};
  char *body = name_attribute(reader, node, "name");
  reader->named_bodies++;
  if (body == NULL) body = format_text("body%zu", reader->named_bodies);
  for (size_t i = 0; i < sizeof components / sizeof *components; i++)
    if (xmlHasProp(node, (const xmlChar *)components[i]))
      definitions_add(reader->definitions, format_text("%s.%s", body, components[i]), node, components[i]);
  free(body);
}

void collect_named_expressions(struct Reader *reader, xmlNodePtr node) {
  const char *element = (const char *)node->name;
  if (strcmp(element, "particle") == 0 || strcmp(element, "body") == 0) collect_components(reader, node);
  if (strcmp(element, "define") != 0 && !is_calculated(node)) return;
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  if (scope_find(reader->scope, name) == NULL) {
    definitions_add(reader->definitions, name, node, is_calculated(node) ? "value" : NULL);
    return;
  }
  scope_define(reader->scope, name, (struct Quantity){.node = ZERO}, xmlGetLineNo(node)); /* says what has the name */
  free(name);
}
