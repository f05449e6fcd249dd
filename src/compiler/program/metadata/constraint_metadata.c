#include "program/metadata/constraint_metadata.h"

#include "algebra/cone.h"
#include "base/memory.h"

/*
 * Marks the inputs that the constraint contains, directly or by their derivatives. Returns their names, NULL for none.
 */
static char *mark_inputs(const struct Model *model, Node constraint, bool *is_prescribed_input) {
  const struct Graph *graph = model->graph;
  struct Cone *cone = graph->cone;
  char *names = NULL;
  cone_collect(cone, graph, &constraint, 1);
  for (size_t i = 0; i < model->inputs.count; i++) {
    if (!cone_has(cone, model->inputs.items[i].node)) continue;
    size_t input = i;
    while (is_input_rate(model, input)) input--;
    is_prescribed_input[input] = true;
    char *before = names;
    names =
        format_text("%s%s%s", before != NULL ? before : "", before != NULL ? ", " : "", model->inputs.items[i].name);
  }
  return names;
}

static bool has_inputs(const struct Model *model) {
  bool has = false;
  for (size_t j = 0; j < model->constraints.count; j++)
    has |= graph_depends_on(model->graph, model->constraints.items[j].node, INPUT);
  return has;
}

static void add_inputs(struct ConstraintTable *metadata, const struct Model *model) {
  bool *is_prescribed_input = allocate(model->inputs.count, sizeof *is_prescribed_input);
  const char **inputs = allocate(model->constraints.count, sizeof *inputs);
  struct PrescribedInput *prescribed_inputs = allocate(model->inputs.count, sizeof *prescribed_inputs);
  for (size_t j = 0; j < model->constraints.count; j++)
    inputs[j] = mark_inputs(model, model->constraints.items[j].node, is_prescribed_input);
  for (size_t i = 0; i < model->inputs.count; i++)
    if (is_prescribed_input[i])
      prescribed_inputs[metadata->prescribed_input_count++] = (struct PrescribedInput){i, input_rate_count(model, i)};
  metadata->inputs = inputs;
  metadata->prescribed_inputs = prescribed_inputs;
}

static const bool *fixed_coordinates(const struct VariableList *coordinates) {
  bool *is_fixed = allocate(coordinates->count, sizeof *is_fixed);
  for (size_t i = 0; i < coordinates->count; i++) is_fixed[i] = coordinates->items[i].is_fixed;
  return is_fixed;
}

struct ConstraintTable constraint_metadata_of(const struct Program *program) {
  const struct Model *model = program->model;
  struct ConstraintTable metadata = {.count = model->constraints.count};
  if (metadata.count == 0) return metadata;
  const char **names = allocate(metadata.count, sizeof *names);
  for (size_t i = 0; i < metadata.count; i++) names[i] = model->constraints.items[i].name;
  metadata.names = names;
  if (has_inputs(model)) add_inputs(&metadata, model);
  if (has_function(program, FUNCTION_START_POSITIONS))
    metadata.coordinate_is_fixed = fixed_coordinates(&model->coordinates);
  return metadata;
}
