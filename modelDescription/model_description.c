#include "model_description.h"

#include <math.h>

#include <libxml/xmlwriter.h>

#include "common_elements.h"
#include "model_structure.h"
#include "type_definitions.h"
#include "xml_output.h"

/* Writes SourceFiles. FMUs without SUNDIALS contain all their sources, as one C file. */
static void write_sources(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Method *method = program->equations->method;
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
  /* after a step the FMU reports a drift from the constraints, and modes that must change */
  if (model->constraints.count == 0 && program->equations->switching == NULL)
    write_attribute(writer, "completedIntegratorStepNotNeeded", "true");
  for (size_t i = 0; i < 3; i++) write_attribute(writer, state_access[i], "true");
  write_sources(writer, program);
  xmlTextWriterEndElement(writer);
  xmlTextWriterStartElement(writer, BAD_CAST "CoSimulation");
  write_attribute(writer, "modelIdentifier", model->name);
  write_attribute(writer, "canHandleVariableCommunicationStepSize", "true");
  if (model->inputs.count > 0) write_attribute(writer, "canInterpolateInputs", "true");
  /* every system has outputs: those declared, or its coordinates */
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "maxOutputDerivativeOrder", "%d",
                                    interface->output_derivative_order);
  for (size_t i = 0; i < 3; i++) write_attribute(writer, state_access[i], "true");
  write_sources(writer, program);
  xmlTextWriterEndElement(writer);
}

static void write_real(xmlTextWriterPtr writer, const struct Interface *interface,
                       const struct InterfaceVariable *variable) {
  enum VariableKind kind = variable->entry.kind;
  xmlTextWriterStartElement(writer, BAD_CAST "Real");
  if (declared_type(variable) != NULL) write_attribute(writer, "declaredType", declared_type(variable));
  if (variable->unit != NULL) write_attribute(writer, "unit", variable->unit);
  if (variable->display_unit != NULL) write_attribute(writer, "displayUnit", variable->display_unit);
  if (!isnan(variable->entry.minimum)) write_number(writer, "min", variable->entry.minimum);
  if (!isnan(variable->entry.maximum)) write_number(writer, "max", variable->entry.maximum);
  if (!isnan(variable->nominal)) write_number(writer, "nominal", variable->nominal);
  if (variable->entry.is_reinitialized) write_attribute(writer, "reinit", "true");
  if (has_start(&variable->entry)) write_number(writer, "start", variable->entry.start);
  if (kind == VARIABLE_DERIVATIVE)
    xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "derivative", "%zu",
                                      interface_find(interface, VARIABLE_STATE, variable->entry.index) + 1);
  xmlTextWriterEndElement(writer);
}

/* Statistics have no start value. */
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
  for (size_t i = 0; i < interface->count_in_fmi2; i++) {
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

bool model_description_write(xmlBufferPtr buffer, const struct Program *program, const char *guid) {
  const struct Model *model = program->model;
  const struct Interface *interface = program->interface;
  xmlTextWriterPtr writer = open_document(buffer, "fmiModelDescription");
  if (writer == NULL) return false;
  write_attribute(writer, "fmiVersion", "2.0");
  write_attribute(writer, "modelName", model->name);
  write_attribute(writer, "guid", guid);
  write_origin(writer, model);
  write_attribute(writer, "variableNamingConvention", naming_convention(model));
  const struct SwitchingExpressions *switching = program->equations->switching;
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "numberOfEventIndicators", "%zu",
                                    switching != NULL ? switching->indicator_count : 0);
  write_interfaces(writer, program);
  write_units(writer, interface, interface->count_in_fmi2);
  write_types(writer, interface, interface->count_in_fmi2, "Real");
  write_log_categories(writer);
  write_experiment(writer, model);
  write_annotations(writer, model, "VendorAnnotations", "Tool", "name");
  write_variables(writer, interface);
  model_structure_write(writer, program, &structure_of_fmi2);
  return close_document(writer);
}
