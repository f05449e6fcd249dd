#include "read/checks.h"

#include <stdlib.h>

static void check_content(const struct Reader *reader) {
  const struct Model *model = reader->model;
  size_t coordinates = model->coordinates.count;
  if (coordinates == 0 && model->outputs.count == 0)
    report_error(reader->diagnostics, 0, "the system has neither coordinates nor outputs; expected some");
  if (coordinates == 0 && (model->body_count > 0 || model->kinetic.node != ZERO || model->has_forces))
    report_error(reader->diagnostics, 0, "masses or forces without coordinates; expected a <coordinate>");
  if (coordinates == 0 && reader->has_solver)
    report_error(reader->diagnostics, model->solver_line,
                 "a system without coordinates has nothing to solve; expected no <solver>");
  if (model->work_line > 0 && !model->has_forces)
    report_error(reader->diagnostics, model->work_line, "<work/> without forces; expected a <force> or <dissipation>");
}

/* A variable of unknown unit agrees with all others, so that a forgotten unit hides mistakes. */
static void warn_without_unit(const struct Reader *reader) {
  const struct Model *model = reader->model;
  const struct VariableList *const lists[] = {&model->parameters, &model->inputs, &model->coordinates};
  for (size_t list = 0; reader->scope->checks_units && list < 3; list++)
    for (size_t i = 0; i < lists[list]->count; i++)
      if (lists[list]->items[i].unit == NULL)
        report_warning(reader->diagnostics, lists[list]->items[i].line,
                       "'%s' has no unit, so that the units of what it stands in are not checked; expected one, or "
                       "unit=\"1\"",
                       lists[list]->items[i].name);
}

static void warn_of_inertia(const struct Reader *reader, const struct Body *body, const char *what, Node inertia,
                            const double *values) {
  if (graph_is_constant(reader->model->graph, inertia) ? values[inertia] >= 0 : values[inertia] > 0) return;
  report_warning(reader->diagnostics, body->line, "the %s of '%s' is %g at the start values; expected a positive one",
                 what, body->name, values[inertia]);
}

static void warn_at_start(const struct Reader *reader) {
  const struct Model *model = reader->model;
  double *symbols = start_values(model), *values = graph_evaluate(model->graph, symbols);
  for (size_t i = 0; i < model->body_count; i++) {
    const struct Body *body = &model->bodies[i];
    warn_of_inertia(reader, body, "mass", body->mass.node, values);
    warn_of_inertia(reader, body, "inertia", body->inertia.node, values);
  }
  warn_outside_domains(&reader->scope->requirements, model->graph, values, reader->diagnostics);
  free(values);
  free(symbols);
}

void check_system(struct Reader *reader) {
  check_content(reader);
  if (reader->diagnostics->errors > 0) return;
  warn_without_unit(reader);
  warn_at_start(reader);
}
