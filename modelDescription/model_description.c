#include "model_description.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/xmlwriter.h>

#include "memory.h"
#include "algebra/formula.h"
#include "model_structure.h"
#include "scene.h"
#include "xml_output.h"

/* FMUs without SUNDIALS are complete in C, as one file that the build makes of system.c and the runtime. */
static void write_sources(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Method *method = program->interface->method;
  if (method != NULL && method->uses_library) return;
  xmlTextWriterStartElement(writer, BAD_CAST "SourceFiles");
  xmlTextWriterStartElement(writer, BAD_CAST "File");
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "name", "%s.c", program->model->name);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
}

static void write_interfaces(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Model *model = program->model;
  const struct Interface *interface = program->interface;
  static const char *const state_access[] = {"canGetAndSetFMUstate", "canSerializeFMUstate",
                                             "providesDirectionalDerivative"};
  xmlTextWriterStartElement(writer, BAD_CAST "ModelExchange");
  write_attribute(writer, "modelIdentifier", model->name);
  /* A step is asked for whether its state has drifted from the constraints. */
  if (model->constraints.count == 0) write_attribute(writer, "completedIntegratorStepNotNeeded", "true");
  for (size_t i = 0; i < 3; i++) write_attribute(writer, state_access[i], "true");
  write_sources(writer, program);
  xmlTextWriterEndElement(writer);
  xmlTextWriterStartElement(writer, BAD_CAST "CoSimulation");
  write_attribute(writer, "modelIdentifier", model->name);
  write_attribute(writer, "canHandleVariableCommunicationStepSize", "true");
  if (model->inputs.count > 0) write_attribute(writer, "canInterpolateInputs", "true");
  /* Every system has outputs: its coordinates, or those that it names. */
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "maxOutputDerivativeOrder", "%d",
                                    interface->output_derivative_order);
  for (size_t i = 0; i < 3; i++) write_attribute(writer, state_access[i], "true");
  write_sources(writer, program);
  xmlTextWriterEndElement(writer);
}

static void write_unit(xmlTextWriterPtr writer, const char *name) {
  struct Dimension dimension;
  const char *problem;
  unit_parse(name, &dimension, &problem);
  xmlTextWriterStartElement(writer, BAD_CAST "Unit");
  write_attribute(writer, "name", name);
  xmlTextWriterStartElement(writer, BAD_CAST "BaseUnit");
  for (int i = 0; i < BASE_UNIT_COUNT; i++)
    if (dimension.exponent[i] != 0)
      xmlTextWriterWriteFormatAttribute(writer, BAD_CAST base_unit_names[i], "%g", dimension.exponent[i]);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
}

static bool contains(const char *const *names, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(names[i], name) == 0) return true;
  return false;
}

/* Each unit once, in the order of the variables. A system has few of them, however many variables. */
static void write_units(xmlTextWriterPtr writer, const struct Interface *interface) {
  const char **written = allocate(interface->count, sizeof *written);
  size_t count = 0;
  for (size_t i = 0; i < interface->count; i++) {
    const char *unit = interface->variables[i].unit;
    if (unit == NULL || contains(written, count, unit)) continue;
    if (count == 0) xmlTextWriterStartElement(writer, BAD_CAST "UnitDefinitions");
    written[count++] = unit;
    write_unit(writer, unit);
  }
  if (count > 0) xmlTextWriterEndElement(writer);
  free(written);
}

static void write_log_categories(xmlTextWriterPtr writer) {
  static const char *const categories[][2] = {{"logEvents", "life cycle"},
                                              {"logStatusWarning", "warnings"},
                                              {"logStatusDiscard", "steps that were not finished"},
                                              {"logStatusError", "errors"},
                                              {"logStatusFatal", "errors that end all instances"},
                                              {"logAll", "all messages"}};
  xmlTextWriterStartElement(writer, BAD_CAST "LogCategories");
  for (size_t i = 0; i < sizeof categories / sizeof *categories; i++) {
    xmlTextWriterStartElement(writer, BAD_CAST "Category");
    write_attribute(writer, "name", categories[i][0]);
    write_attribute(writer, "description", categories[i][1]);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

static void write_experiment(xmlTextWriterPtr writer, const struct Model *model) {
  double start = isnan(model->start_time) ? 0.0 : model->start_time;
  double stop = isnan(model->stop_time) ? start + 10.0 : model->stop_time;
  xmlTextWriterStartElement(writer, BAD_CAST "DefaultExperiment");
  write_number(writer, "startTime", start);
  write_number(writer, "stopTime", stop);
  write_number(writer, "tolerance", interface_tolerance(model));
  write_number(writer, "stepSize", isnan(model->step_size) ? (stop - start) / 1000 : model->step_size);
  xmlTextWriterEndElement(writer);
}

/* Causality, variability and initial by the tables of section 2.2.7. */
static void write_classification(xmlTextWriterPtr writer, const struct InterfaceVariable *variable) {
  const struct ScalarVariable *entry = &variable->entry;
  static const char *const causalities[] = {
      [VARIABLE_TIME] = "independent", [VARIABLE_STATE] = "local",         [VARIABLE_DERIVATIVE] = "local",
      [VARIABLE_INPUT] = "input",      [VARIABLE_PARAMETER] = "parameter", [VARIABLE_RESULT] = "local",
      [VARIABLE_STATISTIC] = "local",
  };
  static const char *const initials[] = {
      [VARIABLE_STATE] = "exact",       [VARIABLE_DERIVATIVE] = "calculated", [VARIABLE_PARAMETER] = "exact",
      [VARIABLE_RESULT] = "calculated", [VARIABLE_STATISTIC] = "calculated",
  };
  bool is_calculated = is_calculated_parameter(entry);
  write_attribute(writer, "causality",
                  entry->is_output ? "output"
                  : is_calculated  ? "calculatedParameter"
                                   : causalities[entry->kind]);
  write_attribute(writer, "variability",
                  entry->kind == VARIABLE_PARAMETER || is_calculated ? "tunable"
                  : entry->kind == VARIABLE_STATISTIC                ? "discrete"
                                                                     : "continuous");
  if (entry->kind <= VARIABLE_STATISTIC && entry->kind != VARIABLE_TIME && entry->kind != VARIABLE_INPUT)
    write_attribute(writer, "initial", starts_nearby(variable) ? "approx" : initials[entry->kind]);
}

static void write_real(xmlTextWriterPtr writer, const struct Interface *interface,
                       const struct InterfaceVariable *variable) {
  enum VariableKind kind = variable->entry.kind;
  xmlTextWriterStartElement(writer, BAD_CAST "Real");
  if (variable->unit != NULL) write_attribute(writer, "unit", variable->unit);
  if (!isnan(variable->entry.minimum)) write_number(writer, "min", variable->entry.minimum);
  if (!isnan(variable->entry.maximum)) write_number(writer, "max", variable->entry.maximum);
  if (!isnan(variable->nominal)) write_number(writer, "nominal", variable->nominal);
  if (kind == VARIABLE_STATE || kind == VARIABLE_INPUT || kind == VARIABLE_PARAMETER)
    write_number(writer, "start", variable->entry.start);
  if (kind == VARIABLE_DERIVATIVE)
    xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "derivative", "%zu",
                                      interface_find(interface, VARIABLE_STATE, variable->entry.index) + 1);
  xmlTextWriterEndElement(writer);
}

/* A statistic has no start value. */
static void write_integer(xmlTextWriterPtr writer, const struct ScalarVariable *entry) {
  xmlTextWriterStartElement(writer, BAD_CAST "Integer");
  if (!isnan(entry->minimum)) write_number(writer, "min", entry->minimum);
  if (!isnan(entry->maximum)) write_number(writer, "max", entry->maximum);
  if (!isnan(entry->start)) write_number(writer, "start", entry->start);
  xmlTextWriterEndElement(writer);
}

static void write_boolean(xmlTextWriterPtr writer, const struct ScalarVariable *entry) {
  xmlTextWriterStartElement(writer, BAD_CAST "Boolean");
  write_attribute(writer, "start", entry->start == 0.0 ? "false" : "true");
  xmlTextWriterEndElement(writer);
}

static void write_variables(xmlTextWriterPtr writer, const struct Interface *interface) {
  xmlTextWriterStartElement(writer, BAD_CAST "ModelVariables");
  for (size_t i = 0; i < interface->count; i++) {
    const struct InterfaceVariable *variable = &interface->variables[i];
    xmlTextWriterStartElement(writer, BAD_CAST "ScalarVariable");
    write_attribute(writer, "name", variable->entry.name);
    xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "valueReference", "%zu", i);
    if (variable->description != NULL) write_attribute(writer, "description", variable->description);
    write_classification(writer, variable);
    if (variable->entry.type == TYPE_INTEGER) write_integer(writer, &variable->entry);
    else if (variable->entry.type == TYPE_BOOLEAN) write_boolean(writer, &variable->entry);
    else write_real(writer, interface, variable);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

/* der(der(x)) is no structured name (section 2.2.9), where a second derivative is der(x,2). */
static const char *naming_convention(const struct Model *model) {
  for (size_t i = 1; i < model->inputs.count; i++)
    if (is_input_rate(model, i) && is_input_rate(model, i - 1)) return "flat";
  return "structured";
}

bool model_description_write(xmlBufferPtr buffer, const struct Program *program, const char *guid) {
  const struct Model *model = program->model;
  const struct Equations *equations = program->equations;
  const struct Interface *interface = program->interface;
  xmlTextWriterPtr writer = xmlNewTextWriterMemory(buffer, 0);
  if (writer == NULL) return false;
  xmlTextWriterSetIndent(writer, 1);
  xmlTextWriterSetIndentString(writer, BAD_CAST "  ");
  xmlTextWriterStartDocument(writer, NULL, "UTF-8", NULL);
  xmlTextWriterStartElement(writer, BAD_CAST "fmiModelDescription");
  write_attribute(writer, "fmiVersion", "2.0");
  write_attribute(writer, "modelName", model->name);
  write_attribute(writer, "guid", guid);
  if (model->description != NULL) write_attribute(writer, "description", model->description);
  write_attribute(writer, "generationTool", "lagrange-fmu");
  write_attribute(writer, "variableNamingConvention", naming_convention(model));
  write_attribute(writer, "numberOfEventIndicators", "0");
  write_interfaces(writer, program);
  write_units(writer, interface);
  write_log_categories(writer);
  write_experiment(writer, model);
  scene_write(writer, model);
  write_variables(writer, interface);
  model_structure_write(writer, model, equations, interface);
  xmlTextWriterEndElement(writer);
  bool written = xmlTextWriterEndDocument(writer) >= 0;
  xmlFreeTextWriter(writer);
  return written;
}
