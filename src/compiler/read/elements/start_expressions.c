#include "read/elements/start_expressions.h"

#include <math.h>
#include <stdlib.h>

#include "read/context/includes.h"
#include "read/context/variables.h"

double preliminary_start(xmlNodePtr node, const char *name) {
  const char *text = attribute(node, name);
  char *end = NULL;
  double number = text != NULL ? strtod(text, &end) : 0.0;
  return end != NULL && *end == '\0' && isfinite(number) ? number : 0.0;
}

static void read_start(struct Reader *reader, xmlNodePtr node, const struct Override *overrides, const char *attribute,
                       struct Variable *variable, struct Dimension dimension) {
  struct Quantity value = {.node = ZERO, .literal = true};
  struct Source *present = enter_override(reader, override_of_attribute(overrides, attribute), &node);
  expression_attribute(reader, node, attribute, IN_MASS, &value);
  require_unit(reader, line_of_attribute(node, attribute), "the start value", value, dimension);
  variable->start_expression = value.node;
  source_enter(reader, present);
}

void read_start_expressions(struct Reader *reader, xmlNodePtr node) {
  size_t index = reader->present->number;
  struct Variable *coordinate = &reader->model->coordinates.items[index];
  const struct Override *overrides = overrides_of(reader, node, coordinate->name);
  struct Variable *velocity = &reader->model->velocities.items[index];
  read_start(reader, node, overrides, "start", coordinate, coordinate->dimension);
  read_start(reader, node, overrides, "velocityStart", velocity, velocity->dimension);
}

void read_start_of_mode(struct Reader *reader, xmlNodePtr node) {
  struct Variable *mode = &reader->model->modes.items[reader->present->number];
  struct Dimension dimension = mode->unit != NULL ? mode->dimension : dimension_one;
  read_start(reader, node, overrides_of(reader, node, mode->name), "start", mode, dimension);
}

void read_start_of_state(struct Reader *reader, xmlNodePtr node) {
  struct Variable *state = &reader->model->states.items[reader->present->number];
  read_start(reader, node, overrides_of(reader, node, state->name), "start", state, state->dimension);
}

static void evaluate_start(struct Reader *reader, struct Variable *variable, const double *values) {
  variable->start = values[variable->start_expression];
  if (isfinite(variable->start)) return;
  report_error(reader->diagnostics, variable->line,
               "the start value of '%s' is %g at the start values of the parameters; expected a finite number",
               variable->name, variable->start);
}

void evaluate_start_expressions(struct Reader *reader) {
  struct Model *model = reader->model;
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  for (size_t i = 0; i < model->coordinates.count; i++) {
    evaluate_start(reader, &model->coordinates.items[i], values);
    evaluate_start(reader, &model->velocities.items[i], values);
  }
  for (size_t i = 0; i < model->modes.count; i++) evaluate_start(reader, &model->modes.items[i], values);
  for (size_t i = 0; i < model->states.count; i++) {
    struct Variable *state = &model->states.items[i];
    evaluate_start(reader, state, values);
    if (reader->diagnostics->errors == 0) check_range(reader, state);
  }
}
