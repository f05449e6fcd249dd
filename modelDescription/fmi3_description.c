#include "fmi3_description.h"

#include <math.h>
#include <stdio.h>

#include <libxml/xmlwriter.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "common_elements.h"
#include "interface/arrays.h"
#include "model_structure.h"
#include "type_definitions.h"
#include "xml_output.h"

static void write_abilities(xmlTextWriterPtr writer, const struct Model *model) {
  static const char *const abilities[] = {"canGetAndSetFMUState", "canSerializeFMUState",
                                          "providesDirectionalDerivatives", "providesAdjointDerivatives"};
  write_attribute(writer, "modelIdentifier", model->name);
  for (size_t i = 0; i < sizeof abilities / sizeof *abilities; i++) write_attribute(writer, abilities[i], "true");
}

static void write_interfaces(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Model *model = program->model;
  xmlTextWriterStartElement(writer, BAD_CAST "ModelExchange");
  write_abilities(writer, model);
  /* after a step the FMU reports a drift from the constraints, and modes that must change */
  if (model->constraints.count > 0 || program->equations->switching != NULL)
    write_attribute(writer, "needsCompletedIntegratorStep", "true");
  xmlTextWriterEndElement(writer);
  xmlTextWriterStartElement(writer, BAD_CAST "CoSimulation");
  write_abilities(writer, model);
  write_attribute(writer, "canHandleVariableCommunicationStepSize", "true");
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "maxOutputDerivativeOrder", "%d",
                                    program->interface->output_derivative_order);
  write_attribute(writer, "providesIntermediateUpdate", "true");
  if (program->equations->switching != NULL) write_attribute(writer, "hasEventMode", "true");
  if (program->equations->method != NULL) {
    /* the solver may finish only a part of a step, and the importer may ask for that */
    write_attribute(writer, "mightReturnEarlyFromDoStep", "true");
    write_attribute(writer, "canReturnEarlyAfterIntermediateUpdate", "true");
  }
  xmlTextWriterEndElement(writer);
}

/* Returns the number of elements of an array; 1 for a scalar. */
static size_t element_count(const struct InterfaceVariable *variable) {
  return variable->array_count > 0 ? variable->array_count : 1;
}

static void write_start(xmlTextWriterPtr writer, const struct InterfaceVariable *variable) {
  struct TextStream text;
  FILE *file = open_text(&text);
  for (size_t i = 0; i < element_count(variable); i++) {
    char number[NUMBER_LENGTH];
    number_text(variable[i].entry.start, number);
    if (variable->entry.type == TYPE_BOOLEAN) fputs(variable[i].entry.start == 0.0 ? "false" : "true", file);
    else fputs(number, file);
    if (i + 1 < element_count(variable)) fputc(' ', file);
  }
  write_attribute(writer, "start", close_text(&text));
}

static void write_numbers(xmlTextWriterPtr writer, const struct Interface *interface,
                          const struct InterfaceVariable *variable) {
  const struct ScalarVariable *entry = &variable->entry;
  if (declared_type(variable) != NULL) write_attribute(writer, "declaredType", declared_type(variable));
  if (variable->unit != NULL && entry->type == TYPE_REAL) write_attribute(writer, "unit", variable->unit);
  if (variable->display_unit != NULL && entry->type == TYPE_REAL)
    write_attribute(writer, "displayUnit", variable->display_unit);
  if (!isnan(entry->minimum)) write_number(writer, "min", entry->minimum);
  if (!isnan(entry->maximum)) write_number(writer, "max", entry->maximum);
  if (!isnan(variable->nominal)) write_number(writer, "nominal", variable->nominal);
  if (entry->is_reinitialized) write_attribute(writer, "reinit", "true");
  if (entry->kind == VARIABLE_DERIVATIVE)
    xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "derivative", "%zu",
                                      interface_find(interface, VARIABLE_STATE, entry->index) + FIRST_REFERENCE);
}

/* Returns the element of the variable's type. Counts of steps may exceed an Int32. */
static const char *type_name(const struct ScalarVariable *entry) {
  static const char *const names[] = {[TYPE_REAL] = "Float64", [TYPE_INTEGER] = "Int32", [TYPE_BOOLEAN] = "Boolean"};
  return entry->kind == VARIABLE_STATISTIC ? "Int64" : names[entry->type];
}

static void write_variable(xmlTextWriterPtr writer, const struct Interface *interface, size_t index) {
  const struct InterfaceVariable *variable = &interface->variables[index];
  char *name = array_name(variable), *description = array_description(variable);
  xmlTextWriterStartElement(writer, BAD_CAST type_name(&variable->entry));
  write_attribute(writer, "name", name);
  xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "valueReference", "%zu", index + FIRST_REFERENCE);
  if (description != NULL) write_attribute(writer, "description", description);
  write_classification(writer, variable);
  if (is_intermediate(&variable->entry)) write_attribute(writer, "intermediateUpdate", "true");
  if (variable->entry.type != TYPE_BOOLEAN) write_numbers(writer, interface, variable);
  if (has_start(&variable->entry)) write_start(writer, variable);
  if (variable->array_count > 0) {
    xmlTextWriterStartElement(writer, BAD_CAST "Dimension");
    xmlTextWriterWriteFormatAttribute(writer, BAD_CAST "start", "%zu", variable->array_count);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

static void write_variables(xmlTextWriterPtr writer, const struct Interface *interface) {
  xmlTextWriterStartElement(writer, BAD_CAST "ModelVariables");
  for (size_t i = 0; i < interface->count; i++)
    if (!interface->variables[i].is_further_element) write_variable(writer, interface, i);
  xmlTextWriterEndElement(writer);
}

bool fmi3_description_write(xmlBufferPtr buffer, const struct Program *program, const char *token) {
  const struct Model *model = program->model;
  xmlTextWriterPtr writer = open_document(buffer, "fmiModelDescription");
  if (writer == NULL) return false;
  write_attribute(writer, "fmiVersion", "3.0");
  write_attribute(writer, "modelName", model->name);
  write_attribute(writer, "instantiationToken", token);
  write_origin(writer, model);
  write_attribute(writer, "variableNamingConvention", naming_convention(model));
  write_interfaces(writer, program);
  write_units(writer, program->interface, program->interface->count);
  write_types(writer, program->interface, program->interface->count, "Float64Type");
  write_log_categories(writer);
  write_experiment(writer, model);
  write_variables(writer, program->interface);
  model_structure_write(writer, program, &structure_of_fmi3);
  write_annotations(writer, model, "Annotations", "Annotation", "type");
  return close_document(writer);
}
