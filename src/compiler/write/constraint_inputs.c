#include "write/constraint_inputs.h"

#include "algebra/cone.h"
#include "base/memory.h"
#include "write/c_text.h"

/* Marks the inputs that the constraint holds, or whose derivatives it holds. Returns their names, NULL for none. */
static char *mark_inputs(const struct Model *model, Node constraint, bool *is_guide) {
  const struct Graph *graph = model->graph;
  struct Cone *cone = graph->cone;
  char *names = NULL;
  cone_collect(cone, graph, &constraint, 1, NULL);
  for (size_t i = 0; i < model->inputs.count; i++) {
    if (!cone_has(cone, model->inputs.items[i].node)) continue;
    size_t input = i;
    while (is_input_rate(model, input)) input--;
    is_guide[input] = true;
    char *before = names;
    names =
        format_text("%s%s%s", before != NULL ? before : "", before != NULL ? ", " : "", model->inputs.items[i].name);
  }
  return names;
}

bool has_constraint_inputs(const struct Model *model) {
  bool has = false;
  for (size_t j = 0; j < model->constraints.count; j++)
    has |= graph_depends_on(model->graph, model->constraints.items[j].node, INPUT);
  return has;
}

void constraint_inputs_write(FILE *file, const struct Model *model) {
  const struct VariableList *constraints = &model->constraints;
  bool *is_guide = allocate(model->inputs.count, sizeof *is_guide);
  fputs("static const char *const constraint_inputs[] = {", file);
  for (size_t j = 0; j < constraints->count; j++) {
    char *names = mark_inputs(model, constraints->items[j].node, is_guide);
    if (names != NULL) write_c_string(file, names);
    else fputs("NULL", file);
    fputs(", ", file);
  }
  fputs("};\n\nstatic const struct Guide guides[] = {", file);
  for (size_t i = 0; i < model->inputs.count; i++)
    if (is_guide[i]) fprintf(file, "{%zu, %zu}, ", i, input_rate_count(model, i));
  fputs("};\n\n", file);
}
