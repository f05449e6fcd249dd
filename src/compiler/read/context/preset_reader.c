#include "read/context/readers.h"

#include <math.h>
#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "names/similar.h"

/* Returns the variables of a kind that can be set before the start; NULL for other kinds. */
static const struct VariableList *settable_variables(const struct Model *model, enum SymbolKind kind) {
  switch (kind) {
  case PARAMETER: return &model->parameters;
  case INPUT: return &model->inputs;
  case COORDINATE: return &model->coordinates;
  case VELOCITY: return &model->velocities;
  case STATE: return &model->states;
  default: return NULL;
  }
}

/* Returns the variable that a name denotes if it can be set before the start; NULL otherwise. */
static const struct Variable *settable_variable(const struct Reader *reader, const char *name) {
  struct Model *model = reader->model;
  const struct Quantity *quantity = scope_find(reader->scope, name);
  if (quantity == NULL || model->graph->vertices[quantity->node].operation != SYMBOL) return NULL;
  const struct Symbol *symbol = graph_symbol_of(model->graph, quantity->node);
  const struct VariableList *list = settable_variables(model, symbol->kind);
  if (list == NULL) return NULL;
  const struct Variable *variable = &list->items[symbol->index];
  /* A calculated parameter that equals another one has the symbol of that one. */
  return strcmp(variable->name, name) == 0 ? variable : NULL;
}

static bool has_value_for(const struct Preset *preset, const char *name) {
  for (size_t i = 0; i < preset->count; i++)
    if (strcmp(preset->values[i].name, name) == 0) return true;
  return false;
}

static void check_preset_value(struct Reader *reader, xmlNodePtr node, const struct Variable *variable, double value) {
  if (value < variable->minimum || value > variable->maximum)
    report_at(reader, node, "'%s': %g is outside min and max; expected a value between them", variable->name, value);
  else if (variable->type == TYPE_INTEGER && value != floor(value))
    report_at(reader, node, "'%s': %g is not an Integer; expected a whole number", variable->name, value);
  else if (variable->type == TYPE_BOOLEAN && value != 0.0 && value != 1.0)
    report_at(reader, node, "'%s': %g is not a Boolean; expected 1 for true or 0 for false", variable->name, value);
}

/* Reads <at name value/> of a preset. */
static void read_value(struct Reader *reader, xmlNodePtr node, struct Preset *preset) {
  char *name = reference_attribute(reader, node, "name");
  double value = NAN;
  if (name == NULL || !number_attribute(reader, node, "value", &value)) return;
  const struct Variable *variable = settable_variable(reader, name);
  const char *similar = scope_find(reader->scope, name) == NULL ? scope_similar_name(reader->scope, name) : NULL;
  if (variable == NULL)
    report_at(reader, node, "the preset names '%s'; %s", name,
              suggestion(similar, "expected a parameter with a start, an input, a coordinate, a velocity or a state"));
  else if (has_value_for(preset, name))
    report_at(reader, node, "the preset names '%s' twice; expected one value", name);
  else {
    check_preset_value(reader, node, variable, value);
    APPEND(preset->values, preset->count, (struct PresetValue){name, value});
  }
}

/* Returns the preset of this name; NULL if there is none. */
static const struct Preset *preset_named(const struct Model *model, const char *name) {
  for (size_t i = 0; i < model->preset_count; i++)
    if (strcmp(model->presets[i].name, name) == 0) return &model->presets[i];
  return NULL;
}

void read_preset(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Preset preset = {.name = name_attribute(reader, node, "name"), .description = attribute(node, "description")};
  if (preset.name == NULL) return;
  if (preset_named(model, preset.name) != NULL)
    report_at(reader, node, "the preset '%s' is defined already; expected another name", preset.name);
  for (xmlNodePtr child = xmlFirstElementChild(node); child != NULL; child = xmlNextElementSibling(child))
    read_value(reader, child, &preset);
  if (xmlFirstElementChild(node) == NULL)
    report_at(reader, node, "the preset '%s' sets nothing; expected <at name=\"...\" value=\"...\"/> in it",
              preset.name);
  APPEND(model->presets, model->preset_count, preset);
}

/* Longest formula, in characters; a longer one takes too long to evaluate for each sample. */
enum { FORMULA_LIMIT = 4000 };

/* Reads <goal min max>expression</goal>. */
static void read_goal(struct Reader *reader, xmlNodePtr node, struct Task *task) {
  struct Goal goal = {.minimum = -INFINITY, .maximum = INFINITY};
  bool has_minimum = number_attribute(reader, node, "min", &goal.minimum);
  bool has_maximum = number_attribute(reader, node, "max", &goal.maximum);
  if (!has_attribute(node, "min") && !has_attribute(node, "max"))
    report_at(reader, node, "the goal has no limits; expected min, max or both");
  if (has_minimum && has_maximum && !(goal.minimum <= goal.maximum))
    report_at(reader, node, "the goal's min is %g, above its max, %g; expected a min below it", goal.minimum,
              goal.maximum);
  char *what = format_text("a goal of the task '%s'", task->name);
  struct Quantity value = whole_expression_of(reader, node, what, IN_FORCE);
  if (reader->diagnostics->errors > 0) return;
  Node present = without_displacements(reader, line_of(node), what, value.node);
  goal.formula = expression_text(reader->model->graph, present);
  if (strlen(goal.formula) > FORMULA_LIMIT)
    report_at(reader, node, "%s is a formula of more than %d characters; expected a shorter one, or an output's name",
              what, FORMULA_LIMIT);
  APPEND(task->goals, task->count, goal);
}

void read_task(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Task task = {.name = name_attribute(reader, node, "name"),
                      .description = attribute(node, "description"),
                      .preset = attribute(node, "preset"),
                      .limit = INFINITY};
  if (task.name == NULL) return;
  if (number_attribute(reader, node, "hold", &task.hold) && !(task.hold >= 0.0))
    report_at(reader, node, "hold is %g s; expected a time of at least 0", task.hold);
  if (number_attribute(reader, node, "limit", &task.limit) && !(task.limit > task.hold))
    report_at(reader, node, "limit is %g s; expected a time above hold, %g s", task.limit, task.hold);
  for (size_t i = 0; i < model->task_count; i++)
    if (strcmp(model->tasks[i].name, task.name) == 0)
      report_at(reader, node, "the task '%s' is defined already; expected another name", task.name);
  if (task.preset != NULL && preset_named(model, task.preset) == NULL)
    report_at(reader, node,
              "the task starts from the preset '%s', which does not exist; expected the name of a <preset>",
              task.preset);
  for (xmlNodePtr child = xmlFirstElementChild(node); child != NULL; child = xmlNextElementSibling(child))
    read_goal(reader, child, &task);
  if (xmlFirstElementChild(node) == NULL)
    report_at(reader, node, "the task '%s' has no goal; expected <goal min=\"...\" max=\"...\">expression</goal> in it",
              task.name);
  APPEND(model->tasks, model->task_count, task);
}
