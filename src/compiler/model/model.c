#include "model/model.h"

#include <math.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"

const char *const shape_type_names[SHAPE_TYPES] = {
    [SHAPE_PLANE] = "plane",        [SHAPE_SPHERE] = "sphere",   [SHAPE_BOX] = "box",
    [SHAPE_CYLINDER] = "cylinder",  [SHAPE_CAPSULE] = "capsule", [SHAPE_MESH] = "mesh",
    [SHAPE_ELLIPSOID] = "ellipsoid"};

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

size_t input_rate_count(const struct Model *model, size_t input) {
  size_t count = 0;
  while (model->prescribed.input_rates[input + count] != ZERO) count++;
  return count;
}

bool is_input_rate(const struct Model *model, size_t input) {
  return input > 0 && model->prescribed.input_rates[input - 1] == model->inputs.items[input].node;
}

bool start_follows(const struct Model *model, const struct Variable *variable) {
  return graph_depends_on(model->graph, variable->start_expression, PARAMETER);
}

double *start_values(const struct Model *model) {
  const struct VariableList *const lists[] = {
      &model->parameters, &model->inputs, &model->coordinates, &model->velocities, &model->states, &model->modes, NULL};
  double *values = allocate(model->graph->symbol_count, sizeof *values);
  values[model->graph->vertices[model->time].left] =
      isnan(model->experiment.start_time) ? 0.0 : model->experiment.start_time;
  for (const struct VariableList *const *list = lists; *list != NULL; list++)
    for (size_t i = 0; i < (*list)->count; i++)
      values[model->graph->vertices[(*list)->items[i].node].left] = (*list)->items[i].start;
  return values;
}

const struct Variable *work_of(const struct Model *model) {
  for (size_t i = 0; i < model->states.count; i++)
    if (model->states.items[i].is_work) return &model->states.items[i];
  return NULL;
}

size_t state_slot(size_t coordinates, const struct Symbol *symbol) {
  size_t first = symbol->kind == VELOCITY ? coordinates : symbol->kind == STATE ? 2 * coordinates : 0;
  return first + (size_t)symbol->index;
}

bool is_motionless(const struct Model *model) {
  return model->coordinates.count + model->states.count == 0;
}

bool has_fixed_coordinates(const struct Model *model) {
  bool has = false;
  for (size_t i = 0; i < model->coordinates.count; i++) has |= model->coordinates.items[i].is_fixed;
  return has;
}

Node unknown_of_row(const struct Model *model, size_t row) {
  size_t n = model->coordinates.count;
  return row < n ? model->unknowns.accelerations[row] : model->unknowns.forces[row - n];
}

Node carried_force(const struct Model *model, size_t constraint) {
  for (size_t i = 0; i < model->switches.contact_count; i++)
    if (model->switches.contacts[i].constraint == constraint) return model->switches.contacts[i].carried;
  return ZERO;
}

Node whole_constraint_force(const struct Model *model, size_t constraint) {
  return add(model->graph, model->unknowns.forces[constraint], carried_force(model, constraint));
}

char *constraint_force_name(const struct Variable *constraint) {
  if (constraint->force_name != NULL) return constraint->force_name;
  return format_text("%s.force", constraint->name);
}

struct Dimension constraint_force_dimension(const struct Variable *constraint) {
  return dimension_multiply(unit_of(constraint->is_of_velocities ? "W" : "J"), constraint->dimension, -1.0);
}

char *variable_unit(const struct Variable *variable) {
  if (variable->unit != NULL) return copy_text(variable->unit);
  return dimension_is_whole(variable->dimension) ? unit_text(variable->dimension) : NULL;
}
