#include "read/context/readers.h"

#include <math.h>

#include "read/context/constraint_checks.h"
#include "read/context/variables.h"

void declare_constraint(struct Reader *reader, xmlNodePtr node) {
  struct Variable constraint = common_attributes(reader, node);
  struct Quantity word = {.node = graph_constant(reader->model->graph, NAN)};
  scope_define(reader->scope, constraint.name, word, constraint.line);
  reader->present->number = reader->model->constraints.count;
  constraint.line = scope_line(reader->scope, constraint.line);
  append_variable(&reader->model->constraints, constraint);
}

void read_constraint(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Variable *constraint = &model->constraints.items[reader->present->number];
  struct Quantity value = expression_text_of(reader, node, "the constraint", IN_CONSTRAINT | KIND(STATE));
  constraint->node = value.node;
  constraint->is_of_velocities = graph_depends_on(model->graph, value.node, VELOCITY);
  scope_set_dimension(reader->scope, constraint_force_name(constraint), constraint_force_dimension(constraint));
  if (constraint->unit != NULL) require_unit(reader, constraint->line, "the constraint", value, constraint->dimension);
  if (reader->diagnostics->errors == 0) check_constraint(reader, constraint);
}
