#include "read/context/task_reader.h"

#include <math.h>
#include <string.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "read/context/preset_reader.h"

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
