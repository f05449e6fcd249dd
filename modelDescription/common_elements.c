#include "common_elements.h"

#include <math.h>
#include <string.h>

#include "algebra/units/other_units.h"
#include "base/memory.h"
#include "scene.h"
#include "xml_output.h"

static bool contains(const char *const *names, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(names[i], name) == 0) return true;
  return false;
}

/* Writes the display units of variables with this unit, each once. */
static void write_display_units(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count,
                                const char *unit) {
  const char **written = allocate(variable_count, sizeof *written);
  size_t count = 0;
  for (size_t i = 0; i < variable_count; i++) {
    const struct InterfaceVariable *variable = &interface->variables[i];
    struct Dimension dimension;
    struct UnitScale scale;
    if (variable->display_unit == NULL || variable->unit == NULL || strcmp(variable->unit, unit) != 0) continue;
    if (contains(written, count, variable->display_unit)) continue;
    written[count++] = variable->display_unit;
    display_unit_parse(variable->display_unit, &dimension, &scale);
    xmlTextWriterStartElement(writer, BAD_CAST "DisplayUnit");
    write_attribute(writer, "name", variable->display_unit);
    write_number(writer, "factor", 1.0 / scale.factor); /* display value = factor * value in the unit + offset */
    if (scale.offset != 0) write_number(writer, "offset", -scale.offset / scale.factor);
    xmlTextWriterEndElement(writer);
  }
}

static void write_base_unit(xmlTextWriterPtr writer, struct Dimension dimension) {
  xmlTextWriterStartElement(writer, BAD_CAST "BaseUnit");
  for (int i = 0; i < BASE_UNIT_COUNT; i++)
    if (dimension.exponent[i] != 0)
      xmlTextWriterWriteFormatAttribute(writer, BAD_CAST base_unit_names[i], "%g", dimension.exponent[i]);
  xmlTextWriterEndElement(writer);
}

static void write_unit(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count,
                       const char *name) {
  struct Dimension dimension = unit_of(name);
  xmlTextWriterStartElement(writer, BAD_CAST "Unit");
  write_attribute(writer, "name", name);
  if (dimension_is_whole(dimension)) write_base_unit(writer, dimension);
  write_display_units(writer, interface, variable_count, name);
  xmlTextWriterEndElement(writer);
}

/* Writes each unit once, in the order of the variables. Searches linearly, as a system has few units. */
void write_units(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count) {
  const char **written = allocate(variable_count, sizeof *written);
  size_t count = 0;
  for (size_t i = 0; i < variable_count; i++) {
    const char *unit = interface->variables[i].unit;
    if (unit == NULL || contains(written, count, unit)) continue;
    if (count == 0) xmlTextWriterStartElement(writer, BAD_CAST "UnitDefinitions");
    written[count++] = unit;
    write_unit(writer, interface, variable_count, unit);
  }
  if (count > 0) xmlTextWriterEndElement(writer);
}

void write_log_categories(xmlTextWriterPtr writer) {
  static const char *const categories[][2] = {
      {"logEvents", "life cycle, and what switches"},       {"logStatusWarning", "warnings"},
      {"logStatusDiscard", "steps that were not finished"}, {"logStatusError", "errors"},
      {"logStatusFatal", "errors that end all instances"},  {"logAll", "all messages"}};
  xmlTextWriterStartElement(writer, BAD_CAST "LogCategories");
  for (size_t i = 0; i < sizeof categories / sizeof *categories; i++) {
    xmlTextWriterStartElement(writer, BAD_CAST "Category");
    write_attribute(writer, "name", categories[i][0]);
    write_attribute(writer, "description", categories[i][1]);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

void write_experiment(xmlTextWriterPtr writer, const struct Model *model) {
  double start = isnan(model->experiment.start_time) ? 0.0 : model->experiment.start_time;
  double stop = isnan(model->experiment.stop_time) ? start + 10.0 : model->experiment.stop_time;
  xmlTextWriterStartElement(writer, BAD_CAST "DefaultExperiment");
  write_number(writer, "startTime", start);
  write_number(writer, "stopTime", stop);
  write_number(writer, "tolerance", interface_tolerance(model));
  write_number(writer, "stepSize",
               isnan(model->experiment.step_size) ? (stop - start) / 1000 : model->experiment.step_size);
  xmlTextWriterEndElement(writer);
}

static void write_preset(xmlTextWriterPtr writer, const struct Preset *preset) {
  xmlTextWriterStartElement(writer, BAD_CAST "preset");
  write_attribute(writer, "name", preset->name);
  if (preset->description != NULL) write_attribute(writer, "description", preset->description);
  for (size_t i = 0; i < preset->count; i++) {
    xmlTextWriterStartElement(writer, BAD_CAST "at");
    write_attribute(writer, "name", preset->values[i].name);
    write_number(writer, "value", preset->values[i].value);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

static void write_presets(xmlTextWriterPtr writer, const struct Model *model) {
  xmlTextWriterStartElement(writer, BAD_CAST "presets");
  for (size_t i = 0; i < model->preset_count; i++) write_preset(writer, &model->presets[i]);
  xmlTextWriterEndElement(writer);
}

static void write_task(xmlTextWriterPtr writer, const struct Task *task) {
  xmlTextWriterStartElement(writer, BAD_CAST "task");
  write_attribute(writer, "name", task->name);
  if (task->description != NULL) write_attribute(writer, "description", task->description);
  if (task->preset != NULL) write_attribute(writer, "preset", task->preset);
  write_number(writer, "hold", task->hold);
  if (isfinite(task->limit)) write_number(writer, "limit", task->limit);
  for (size_t i = 0; i < task->count; i++) {
    const struct Goal *goal = &task->goals[i];
    xmlTextWriterStartElement(writer, BAD_CAST "goal");
    if (isfinite(goal->minimum)) write_number(writer, "min", goal->minimum);
    if (isfinite(goal->maximum)) write_number(writer, "max", goal->maximum);
    write_attribute(writer, "formula", goal->formula);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

static void write_tasks(xmlTextWriterPtr writer, const struct Model *model) {
  xmlTextWriterStartElement(writer, BAD_CAST "tasks");
  for (size_t i = 0; i < model->task_count; i++) write_task(writer, &model->tasks[i]);
  xmlTextWriterEndElement(writer);
}

void write_annotations(xmlTextWriterPtr writer, const struct Model *model, const char *all, const char *each,
                       const char *attribute) {
  const struct {
    bool exists;
    const char *name;
    void (*write)(xmlTextWriterPtr writer, const struct Model *model);
  } annotations[] = {{has_scene(model), "lagrange-fmu", scene_write},
                     {model->preset_count > 0, "lagrange-fmu.presets", write_presets},
                     {model->task_count > 0, "lagrange-fmu.tasks", write_tasks}};
  const size_t count = sizeof annotations / sizeof *annotations;
  bool any = false;
  for (size_t i = 0; i < count; i++) any |= annotations[i].exists;
  if (!any) return;
  xmlTextWriterStartElement(writer, BAD_CAST all);
  for (size_t i = 0; i < count; i++) {
    if (!annotations[i].exists) continue;
    xmlTextWriterStartElement(writer, BAD_CAST each);
    write_attribute(writer, attribute, annotations[i].name);
    annotations[i].write(writer, model);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

bool has_start(const struct ScalarVariable *entry) {
  return entry->kind == VARIABLE_STATE || entry->kind == VARIABLE_INPUT || entry->kind == VARIABLE_PARAMETER ||
         entry->kind == VARIABLE_MODE;
}

/* True if the variable changes only at events and communication points. */
static bool is_discrete(const struct ScalarVariable *entry) {
  return entry->kind == VARIABLE_STATISTIC || entry->kind == VARIABLE_MODE || entry->kind == VARIABLE_CONTACT;
}

/* Follows the tables of FMI 2.0.4, section 2.2.7, and FMI 3.0, section 2.4.7.4. */
void write_classification(xmlTextWriterPtr writer, const struct InterfaceVariable *variable) {
  const struct ScalarVariable *entry = &variable->entry;
  static const char *const causalities[] = {
      [VARIABLE_TIME] = "independent", [VARIABLE_STATE] = "local",         [VARIABLE_DERIVATIVE] = "local",
      [VARIABLE_INPUT] = "input",      [VARIABLE_PARAMETER] = "parameter", [VARIABLE_RESULT] = "local",
      [VARIABLE_STATISTIC] = "local",  [VARIABLE_MODE] = "local",          [VARIABLE_CONTACT] = "local",
      [VARIABLE_INDICATOR] = "local",
  };
  static const char *const initials[] = {
      [VARIABLE_STATE] = "exact",        [VARIABLE_DERIVATIVE] = "calculated", [VARIABLE_PARAMETER] = "exact",
      [VARIABLE_RESULT] = "calculated",  [VARIABLE_STATISTIC] = "calculated",  [VARIABLE_MODE] = "exact",
      [VARIABLE_CONTACT] = "calculated", [VARIABLE_INDICATOR] = "calculated",
  };
  bool is_calculated = is_calculated_parameter(entry);
  write_attribute(writer, "causality",
                  entry->is_output ? "output"
                  : is_calculated  ? "calculatedParameter"
                                   : causalities[entry->kind]);
  write_attribute(writer, "variability",
                  entry->kind == VARIABLE_PARAMETER || is_calculated ? "tunable"
                  : is_discrete(entry)                               ? "discrete"
                                                                     : "continuous");
  if (entry->kind != VARIABLE_TIME && entry->kind != VARIABLE_INPUT)
    write_attribute(writer, "initial", starts_nearby(variable) ? "approx" : initials[entry->kind]);
}

/* der(der(x)) is not a structured name (FMI 2.0.4, section 2.2.9), which requires der(x,2). */
const char *naming_convention(const struct Model *model) {
  for (size_t i = 1; i < model->inputs.count; i++)
    if (is_input_rate(model, i) && is_input_rate(model, i - 1)) return "flat";
  return "structured";
}

void write_origin(xmlTextWriterPtr writer, const struct Model *model) {
  const char *const attributes[][2] = {
      {"description", model->description}, {"author", model->origin.author},
      {"version", model->origin.version},  {"copyright", model->origin.copyright},
      {"license", model->origin.license},  {"generationTool", "lagrange-fmu " LAGC_VERSION}};
  for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++)
    if (attributes[i][1] != NULL) write_attribute(writer, attributes[i][0], attributes[i][1]);
}
