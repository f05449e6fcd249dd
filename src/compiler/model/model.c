#include "model/model.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/simplify.h"
#include "base/memory.h"

void add_term(struct Model *model, struct Quantity *sum, Node term) {
  sum->node = add(model->graph, sum->node, term);
}

struct Variable variable_create(char *name, char *description, long line) {
  return (struct Variable){.name = name,
                           .description = description,
                           .dimension = dimension_unknown,
                           .start = NAN,
                           .minimum = NAN,
                           .maximum = NAN,
                           .nominal = NAN,
                           .line = line};
}

void variable_free(struct Variable *variable) {
  free(variable->name);
  free(variable->description);
  free(variable->unit);
}

static void free_variables(struct VariableList *list) {
  for (size_t i = 0; i < list->count; i++) variable_free(&list->items[i]);
  free(list->items);
}

void model_free(struct Model *model) {
  if (model == NULL) return;
  free_variables(&model->parameters);
  free_variables(&model->inputs);
  free_variables(&model->coordinates);
  free_variables(&model->velocities);
  free_variables(&model->outputs);
  free_variables(&model->calculated);
  free_variables(&model->definitions);
  free_variables(&model->displacements);
  free_variables(&model->modes);
  switches_clear(&model->switches);
  free_variables(&model->reactions);
  free_variables(&model->constraints);
  free_variables(&model->places);
  for (size_t i = 0; i < model->body_count; i++) free(model->bodies[i].name);
  for (size_t i = 0; i < model->frame_count; i++) free(model->frames[i].name);
  free(model->frames);
  free(model->stillnesses);
  free(model->torques);
  free(model->bodies);
  free(model->accelerations);
  free(model->constraint_forces);
  free(model->forces);
  free(model->drives);
  free(model->input_rates);
  free(model->point_forces);
  free(model->point.values);
  free(model->point.given);
  graph_free(model->graph);
  free(model->name);
  free(model->description);
  free(model);
}

bool is_input_rate(const struct Model *model, size_t input) {
  return input > 0 && model->input_rates[input - 1] == model->inputs.items[input].node;
}

bool start_follows(const struct Model *model, const struct Variable *variable) {
  return graph_depends_on(model->graph, variable->start_expression, PARAMETER);
}

double *start_values(const struct Model *model) {
  const struct VariableList *const lists[] = {&model->parameters, &model->inputs, &model->coordinates,
                                              &model->velocities};
  double *values = allocate(model->graph->symbol_count, sizeof *values);
  values[model->graph->vertices[model->time].left] = isnan(model->start_time) ? 0.0 : model->start_time;
  for (size_t list = 0; list < 4; list++)
    for (size_t i = 0; i < lists[list]->count; i++)
      values[model->graph->vertices[lists[list]->items[i].node].left] = lists[list]->items[i].start;
  return values;
}

bool has_fixed_coordinates(const struct Model *model) {
  bool has = false;
  for (size_t i = 0; i < model->coordinates.count; i++) has |= model->coordinates.items[i].is_fixed;
  return has;
}

Node unknown_of_row(const struct Model *model, size_t row) {
  size_t n = model->coordinates.count;
  return row < n ? model->accelerations[row] : model->constraint_forces[row - n];
}

char *variable_unit(const struct Variable *variable) {
  if (variable->unit != NULL) return copy_text(variable->unit);
  return dimension_is_whole(variable->dimension) ? unit_text(variable->dimension) : NULL;
}
