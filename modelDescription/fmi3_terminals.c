#include <string.h>

#include <libxml/xmlwriter.h>

#include "algebra/differentiate.h"
#include "fmi3_description.h"
#include "xml_output.h"

/* Names of what a flange is made of, by the unit of its coordinate. */
struct Flange {
  const char *unit, *position, *velocity, *force, *description;
};

static const struct Flange flanges[] = {
    {"m", "position", "velocity", "force", "mechanical flange that is shifted"},
    {"rad", "angle", "angularVelocity", "torque", "mechanical flange that is turned"},
};

static const struct Flange *flange_of(const struct Variable *coordinate) {
  for (size_t i = 0; i < sizeof flanges / sizeof *flanges; i++)
    if (coordinate->unit != NULL && strcmp(coordinate->unit, flanges[i].unit) == 0) return &flanges[i];
  return NULL;
}

/* Whether the input is a force along the coordinate, and along no other. */
static bool acts_along(const struct Model *model, const struct Variable *input, size_t coordinate) {
  for (size_t i = 0; i < model->coordinates.count; i++)
    if (derivative_by(model->graph, model->forces[i].node, input->node) != (i == coordinate ? ONE : ZERO)) return false;
  return true;
}

/* The only input that is a force along the coordinate; NULL where there is none, or several. */
static const struct Variable *force_on(const struct Model *model, size_t coordinate) {
  const struct Variable *found = NULL;
  for (size_t i = 0; i < model->inputs.count; i++) {
    if (!acts_along(model, &model->inputs.items[i], coordinate)) continue;
    if (found != NULL) return NULL;
    found = &model->inputs.items[i];
  }
  return found;
}

static void write_member(xmlTextWriterPtr writer, const char *variable, const char *member, const char *kind) {
  xmlTextWriterStartElement(writer, BAD_CAST "TerminalMemberVariable");
  write_attribute(writer, "variableName", variable);
  write_attribute(writer, "memberName", member);
  write_attribute(writer, "variableKind", kind);
  xmlTextWriterEndElement(writer);
}

static bool is_scalar(const struct Interface *interface, enum VariableKind kind, size_t index) {
  const struct InterfaceVariable *variable = &interface->variables[interface_find(interface, kind, index)];
  return variable->array_count == 0 && !variable->is_further_element;
}

/* A force on a flange flows into the system: those of connected flanges add up to 0. */
static bool write_terminal(xmlTextWriterPtr writer, const struct Program *program, size_t i, bool is_open) {
  const struct Model *model = program->model;
  const struct Variable *coordinate = &model->coordinates.items[i], *input = force_on(model, i);
  const struct Flange *flange = flange_of(coordinate);
  if (flange == NULL || input == NULL || !is_scalar(program->interface, VARIABLE_STATE, i) ||
      !is_scalar(program->interface, VARIABLE_INPUT, (size_t)(input - model->inputs.items)))
    return is_open;
  if (!is_open) xmlTextWriterStartElement(writer, BAD_CAST "Terminals");
  xmlTextWriterStartElement(writer, BAD_CAST "Terminal");
  write_attribute(writer, "name", coordinate->name);
  write_attribute(writer, "matchingRule", "plug");
  write_attribute(writer, "description",
                  coordinate->description != NULL ? coordinate->description : flange->description);
  write_member(writer, coordinate->name, flange->position, "signal");
  write_member(writer, model->velocities.items[i].name, flange->velocity, "signal");
  write_member(writer, input->name, flange->force, "inflow");
  xmlTextWriterEndElement(writer);
  return true;
}

/* terminalsAndIcons/icon.png fills the whole of the system's picture. */
static void write_icon(xmlTextWriterPtr writer) {
  static const char *const corners[] = {"x1", "y1", "x2", "y2"};
  static const char *const elements[] = {"CoordinateSystem", "Icon"};
  xmlTextWriterStartElement(writer, BAD_CAST "GraphicalRepresentation");
  for (int element = 0; element < 2; element++) {
    xmlTextWriterStartElement(writer, BAD_CAST elements[element]);
    for (int i = 0; i < 4; i++) write_number(writer, corners[i], i < 2 ? -100.0 : 100.0);
    if (element == 0) write_number(writer, "suggestedScalingFactorTo_mm", 0.1);
    xmlTextWriterEndElement(writer);
  }
  xmlTextWriterEndElement(writer);
}

bool fmi3_terminals_write(xmlBufferPtr buffer, const struct Program *program) {
  bool is_open = false;
  xmlTextWriterPtr writer = open_document(buffer, "fmiTerminalsAndIcons");
  if (writer == NULL) return false;
  write_attribute(writer, "fmiVersion", "3.0");
  write_icon(writer);
  for (size_t i = 0; i < program->model->coordinates.count; i++) is_open = write_terminal(writer, program, i, is_open);
  if (is_open) xmlTextWriterEndElement(writer);
  return close_document(writer);
}
