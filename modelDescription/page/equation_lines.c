#include "equation_lines.h"

#include <ctype.h>

#include "base/memory.h"
#include "derivation.h"
#include "mechanics_sections.h"
#include "value_sections.h"

void write_equations(struct Page *page) {
  write_calculated(page);
  write_definitions(page);
  write_starts(page);
  if (page->equations->count > 0) write_mechanics(page);
  write_rates(page);
  write_outputs(page);
  write_derivation(page);
}

/* Returns the text without tabs and ends of lines; "" for NULL. */
static char *in_one_line(const char *text) {
  char *line = copy_text(text != NULL ? text : "");
  for (char *at = line; *at != '\0'; at++)
    if (iscntrl((unsigned char)*at)) *at = ' ';
  return line;
}

static void print_variables(FILE *file, const struct Model *model, const char *kind, const struct VariableList *list,
                            const double *starts) {
  for (size_t i = 0; i < list->count; i++) {
    const struct Variable *variable = &list->items[i];
    fprintf(file, "%s\t%s\t%s\t%.17g\t%s\n", kind, variable->name, in_one_line(variable_unit(variable)),
            starts[model->graph->vertices[variable->node].left], in_one_line(variable->description));
  }
}

/* Prints the name of a constraint that switches, and of its mode. */
static void print_switch(FILE *file, const struct Model *model, const char *kind, size_t constraint, Node mode) {
  fprintf(file, "%s\t%s\t%s\n", kind, model->constraints.items[constraint].name,
          graph_symbol_of(model->graph, mode)->name);
}

void equations_print(FILE *file, const struct Model *model, const struct Equations *equations,
                     const struct Summary *summary) {
  const struct Switches *switches = &model->switches;
  struct Display display = {.graph = model->graph, .names = &summary->names};
  struct Page page = {.lines = file, .model = model, .equations = equations, .summary = summary, .display = &display};
  const double *starts = start_values(model);
  fprintf(file, "system\t%s\t%s\t%s\n", model->name, in_one_line(model->description), LAGC_VERSION);
  print_variables(file, model, "parameter", &model->parameters, starts);
  print_variables(file, model, "input", &model->inputs, starts);
  print_variables(file, model, "coordinate", &model->coordinates, starts);
  print_variables(file, model, "velocity", &model->velocities, starts);
  print_variables(file, model, "state", &model->states, starts);
  for (size_t i = 0; i < model->constraints.count; i++)
    fprintf(file, "multiplier\t%s\t%s\n", constraint_force_name(&model->constraints.items[i]),
            model->constraints.items[i].name);
  for (size_t i = 0; i < switches->contact_count; i++)
    print_switch(file, model, "contact", switches->contacts[i].constraint, switches->contacts[i].mode);
  for (size_t i = 0; i < switches->friction_count; i++)
    print_switch(file, model, "friction", switches->frictions[i].constraint, switches->frictions[i].mode);
  write_equations(&page);
}
