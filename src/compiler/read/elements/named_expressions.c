#include "read/elements/named_expressions.h"

#include <string.h>

#include "base/memory.h"
#include "read/context/variables.h"
#include "names/definitions.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"
#include "read/space/joints.h"
#include "read/space/springs.h"

bool has_value(xmlNodePtr node, const struct Override *overrides) {
  if (!is_element(node, "parameter") && !is_element(node, "input")) return false;
  return override_of_value(overrides) != NULL ||
         (override_of_attribute(overrides, "start") == NULL && has_attribute(node, "value"));
}

/* Checks the value of a definition, parameter or input against the unit that it gives, and returns it in this unit. */
static struct Quantity in_own_unit(struct Reader *reader, const struct NamedExpression *expression,
                                   struct Quantity value) {
  xmlNodePtr node = expression->node, where = expression->overrides != NULL ? expression->overrides->node : node;
  const char *what = expression->attribute == NULL   ? "the definition"
                     : is_element(node, "parameter") ? "the value of the parameter"
                                                     : "the value of the input";
  struct Source *present = source_enter(reader, expression->source);
  struct Dimension unit = unit_attribute(reader, node, "unit");
  source_enter(reader, present);
  require_unit(reader, line_of_attribute(where, "value"), what, value, unit);
  if (!unit.known) return value;
  return (struct Quantity){.node = value.node, .dimension = unit, .at_instant = value.at_instant, .whole = value.whole};
}

/*
 * Reads the text of an element as an expression. If modes occur in it, reads it twice more for <set>. Once abs, min
 * and if are evaluated directly at the event, once the expression is unsplit.
 */
static struct Quantity read_text(struct Reader *reader, xmlNodePtr node, const char *what) {
  struct Quantity value = expression_text_of(reader, node, what, IN_OUTPUT);
  bool is_read = reader->diagnostics->errors == 0 && !definitions_are_waiting(reader->definitions);
  if (!is_read || !graph_depends_on(reader->model->graph, value.node, MODE)) return value;
  size_t requirements = reader->scope->requirements.count;
  value.at_instant = expression_text_of(reader, node, what, IN_OUTPUT | AT_INSTANT).node;
  value.whole = whole_expression_of(reader, node, what, IN_OUTPUT | AT_INSTANT).node;
  reader->scope->requirements.count = requirements;
  return value;
}

struct Quantity read_output_value(struct Reader *reader, xmlNodePtr node, const char *name, struct Dimension unit) {
  char *what = format_text("the output '%s'", name);
  struct Quantity value = read_text(reader, node, what);
  if (definitions_are_waiting(reader->definitions)) return value;
  require_unit(reader, line_of(node), what, value, unit);
  if (unit.known) value.dimension = unit;
  Node *const nodes[] = {&value.node, &value.at_instant, &value.whole};
  for (size_t i = 0; i < sizeof nodes / sizeof *nodes; i++)
    *nodes[i] = without_displacements(reader, line_of(node), what, *nodes[i]);
  return value;
}

static struct Quantity read_component(struct Reader *reader, xmlNodePtr node, const char *component) {
  struct Quantity value = {.node = ZERO};
  bool is_angle = strcmp(component, "angle") == 0;
  expression_attribute(reader, node, component, IN_POSITION, &value);
  if (definitions_are_waiting(reader->definitions)) return value;
  struct Dimension unit = unit_of(is_angle ? "rad" : "m");
  require_unit(reader, line_of_attribute(node, component), is_angle ? "the angle" : component, value, unit);
  return (struct Quantity){.node = value.node, .dimension = value.dimension.known ? unit : dimension_unknown};
}

/* Reads the time derivative of a state. */
static struct Quantity read_rate(struct Reader *reader, xmlNodePtr node) {
  struct Quantity rate = {.node = ZERO};
  expression_attribute(reader, node, "rate", IN_RATE, &rate);
  if (definitions_are_waiting(reader->definitions)) return rate;
  struct Dimension unit = dimension_multiply(unit_attribute(reader, node, "unit"), unit_of("s"), -1.0);
  require_unit(reader, line_of_attribute(node, "rate"), "the rate", rate, unit);
  return rate;
}

struct Quantity read_named_expression(struct Reader *reader, const struct NamedExpression *expression,
                                      const char *name) {
  struct Quantity value = {.node = ZERO};
  xmlNodePtr node = expression->node;
  const struct Override *overrides = expression->overrides;
  bool is_parameter = is_element(node, "parameter"), is_input = is_element(node, "input");
  struct Source *present = source_enter(reader, overrides != NULL ? overrides->source : expression->source);
  if (is_spatial(node) || (expression->attribute != NULL && *expression->attribute == '\0'))
    value = read_spatial(reader, node, name, expression->attribute);
  else if (is_element(node, "state")) value = read_rate(reader, node);
  else if (is_element(node, "spring")) value = read_spring_value(reader, node, expression->attribute);
  else if (is_element(node, "joint")) value = read_joint_force(reader, node, name);
  else if (is_element(node, "output"))
    return read_output_value(reader, node, name, unit_attribute(reader, node, "unit"));
  else if (expression->attribute == NULL) value = read_text(reader, node, "the definition");
  else if (is_parameter || is_input)
    expression_attribute(reader, overrides != NULL ? overrides->node : node, expression->attribute,
                         is_parameter ? IN_MASS : IN_OUTPUT, &value);
  else value = read_component(reader, node, expression->attribute);
  if (!definitions_are_waiting(reader->definitions) && (expression->attribute == NULL || is_parameter || is_input))
    value = in_own_unit(reader, expression, value);
  source_enter(reader, present);
  return value;
}

/* Stores the rate of a state. name: der(STATE). */
static void keep_rate(struct Reader *reader, const char *name, struct Quantity value) {
  struct Model *model = reader->model;
  for (size_t i = 0; i < model->states.count; i++) {
    struct Variable *state = &model->states.items[i];
    if (state->is_work || strcmp(name, format_text("der(%s)", state->name)) != 0) continue;
    state->rate = value.node;
    scope_set_time_derivative(reader->scope, state->node, value.node);
  }
}

void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value) {
  if (is_element(node, "state")) keep_rate(reader, name, value);
  bool is_parameter = is_element(node, "parameter");
  if (!is_parameter && !is_element(node, "define") && !is_element(node, "input")) return;
  struct Variable variable = {.name = copy_text(name),
                              .description = attribute(node, "description"),
                              .unit = attribute(node, "unit"),
                              .display_unit = display_unit_attribute(reader, node, "displayUnit", value.dimension),
                              .dimension = value.dimension,
                              .node = without_displacements(reader, line_of(node), "the definition", value.node)};
  variable.shown =
      value.whole == ZERO ? variable.node : without_displacements(reader, line_of(node), "the definition", value.whole);
  append_variable(is_parameter ? &reader->model->calculated : &reader->model->definitions, variable);
}

static void collect_planar(struct Reader *reader, xmlNodePtr node, const char *body) {
  static const char *const components[] = {"x", "y", "z", "angle"};
  for (size_t i = 0; i < sizeof components / sizeof *components; i++)
    if (has_attribute(node, components[i]))
      definitions_add(reader->definitions, format_text("%s.%s", body, components[i]),
                      &(struct NamedExpression){node, components[i], reader->source, NULL});
  if (is_element(node, "body")) collect_frame(reader, node, body);
}

void collect_components(struct Reader *reader, xmlNodePtr node) {
  char *name = name_of_body(reader, node);
  if (name != NULL && is_spatial(node)) collect_spatial(reader, node, name);
  else if (name != NULL) collect_planar(reader, node, name);
}

void collect_output(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  if (name != NULL && scope_find(reader->scope, name) == NULL)
    definitions_add(reader->definitions, name, &(struct NamedExpression){.node = node, .source = reader->source});
}

void collect_value(struct Reader *reader, xmlNodePtr node) {
  bool is_definition = is_element(node, "define");
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  const struct Override *overrides = is_definition ? NULL : overrides_of(reader, node, name);
  if (!is_definition && !has_value(node, overrides)) return;
  if (scope_find(reader->scope, name) == NULL) {
    struct NamedExpression expression = {node, is_definition ? NULL : "value", reader->source,
                                         override_of_value(overrides)};
    definitions_add(reader->definitions, name, &expression);
    return;
  }
  scope_define(reader->scope, name, (struct Quantity){.node = ZERO}, line_of(node)); /* reports the name as taken */
}
