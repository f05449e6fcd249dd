#include <math.h>
#include <string.h>

#include <libxml/xmlwriter.h>

#include "algebra/differentiate.h"
#include "base/memory.h"
#include "fmi3_description.h"
#include "interface/arrays.h"
#include "xml_output.h"

/* A flange, by the unit of its coordinate, with the names of Modelica's connector and adaptors to signals. */
struct Flange {
  const char *unit, *position, *velocity, *force, *kind, *description;
};

static const struct Flange flanges[] = {
    {"m", "s", "v", "f", "Modelica.Mechanics.Translational.Interfaces.Flange_a", "mechanical flange that is shifted"},
    {"rad", "phi", "w", "tau", "Modelica.Mechanics.Rotational.Interfaces.Flange_a",
     "mechanical flange that is rotated"},
};

static const struct Flange *flange_of(const struct Variable *coordinate) {
  for (size_t i = 0; i < sizeof flanges / sizeof *flanges; i++)
    if (coordinate->unit != NULL && strcmp(coordinate->unit, flanges[i].unit) == 0) return &flanges[i];
  return NULL;
}

/* Instead of an index: no input, and several. */
enum { NONE = -1, SEVERAL = -2 };

/* Returns, for each coordinate, the index of the input that is the force along it alone; or NONE or SEVERAL. */
static int *find_forces(const struct Model *model) {
  size_t inputs = model->inputs.count, coordinates = model->coordinates.count;
  int *coordinate_of = allocate(inputs + 1, sizeof *coordinate_of), *force = allocate(coordinates + 1, sizeof *force);
  for (size_t i = 0; i < inputs; i++) coordinate_of[i] = NONE;
  for (size_t i = 0; i < coordinates; i++) {
    struct Gradient gradient = gradient_by_kinds(model->graph, model->forces.along[i].node, 1u << INPUT);
    for (size_t j = 0; j < gradient.count; j++) {
      int *coordinate = &coordinate_of[graph_symbol_of(model->graph, gradient.symbols[j])->index];
      *coordinate = *coordinate == NONE && gradient.values[j] == ONE ? (int)i : SEVERAL;
    }
    force[i] = NONE;
  }
  for (size_t i = 0; i < inputs; i++)
    if (coordinate_of[i] >= 0) force[coordinate_of[i]] = force[coordinate_of[i]] == NONE ? (int)i : SEVERAL;
  return force;
}

static void write_member(xmlTextWriterPtr writer, const struct InterfaceVariable *variable, const char *member,
                         const char *kind) {
  char *name = array_name(variable);
  xmlTextWriterStartElement(writer, BAD_CAST "TerminalMemberVariable");
  write_attribute(writer, "variableName", name);
  write_attribute(writer, "memberName", member);
  write_attribute(writer, "variableKind", kind);
  xmlTextWriterEndElement(writer);
}

/* The variables of a terminal: scalars, or arrays with an element for each of several flanges. */
struct Members {
  const struct InterfaceVariable *position, *velocity, *force; /* NULL without a terminal */
};

static bool are_of_one_size(const struct InterfaceVariable *a, const struct InterfaceVariable *b) {
  return a->array_count == b->array_count && !b->is_further_element;
}

/* Returns the terminal of a coordinate, or of the array that begins with it. force: from find_forces(). */
static struct Members members_of(const struct Program *program, const int *force, size_t coordinate) {
  const struct Interface *interface = program->interface;
  const struct Members none = {NULL, NULL, NULL};
  const struct InterfaceVariable *position =
      &interface->variables[interface_find(interface, VARIABLE_STATE, coordinate)];
  if (position->is_further_element || force[coordinate] < 0) return none;
  for (size_t i = 1; i < position->array_count; i++)
    if (force[coordinate + i] != force[coordinate] + (int)i) return none;
  struct Members members = {
      position, position + program->model->coordinates.count,
      &interface->variables[interface_find(interface, VARIABLE_INPUT, (size_t)force[coordinate])]};
  return are_of_one_size(position, members.velocity) && are_of_one_size(position, members.force) ? members : none;
}

/* The right edge of the icon, with the terminals side by side. */
struct Edge {
  size_t count, number;
};

/* Writes the position of a flange, half of which is outside the icon. */
static void write_position(xmlTextWriterPtr writer, const struct Edge *edge) {
  double half = fmin(10.0, 80.0 / (double)edge->count);
  double height = 100.0 - 200.0 * ((double)edge->number + 0.5) / (double)edge->count;
  xmlTextWriterStartElement(writer, BAD_CAST "TerminalGraphicalRepresentation");
  write_attribute(writer, "defaultConnectionColor", "26 95 180");
  write_number(writer, "x1", 100.0 - half);
  write_number(writer, "y1", height - half);
  write_number(writer, "x2", 100.0 + half);
  write_number(writer, "y2", height + half);
  write_attribute(writer, "iconBaseName", "flange");
  xmlTextWriterEndElement(writer);
}

/*
 * Writes a terminal. Forces are inflows: those of connected flanges add up to 0. The matching rule is bus, since
 * Modelica's connector has no velocity, which an external damper needs.
 */
static void write_terminal(xmlTextWriterPtr writer, const struct Program *program, const int *force, size_t coordinate,
                           const struct Edge *edge) {
  const struct Flange *flange = flange_of(&program->model->coordinates.items[coordinate]);
  struct Members members = members_of(program, force, coordinate);
  char *name = array_name(members.position), *description = array_description(members.position);
  xmlTextWriterStartElement(writer, BAD_CAST "Terminal");
  write_attribute(writer, "name", name);
  write_attribute(writer, "matchingRule", "bus");
  if (members.position->array_count < 2)
    write_attribute(writer, "terminalKind", flange->kind); /* an array of flanges is not one connector */
  write_attribute(writer, "description", description != NULL ? description : flange->description);
  write_member(writer, members.position, flange->position, "signal");
  write_member(writer, members.velocity, flange->velocity, "signal");
  write_member(writer, members.force, flange->force, "inflow");
  write_position(writer, edge);
  xmlTextWriterEndElement(writer);
}

static bool has_terminal(const struct Program *program, const int *force, size_t coordinate) {
  return flange_of(&program->model->coordinates.items[coordinate]) != NULL &&
         members_of(program, force, coordinate).position != NULL;
}

/* Writes the coordinate system and the icon, which fills it. */
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

size_t fmi3_terminal_count(const struct Program *program) {
  int *force = find_forces(program->model);
  size_t count = 0;
  for (size_t i = 0; i < program->model->coordinates.count; i++) count += has_terminal(program, force, i);
  return count;
}

bool fmi3_terminals_write(xmlBufferPtr buffer, const struct Program *program) {
  xmlTextWriterPtr writer = open_document(buffer, "fmiTerminalsAndIcons");
  if (writer == NULL) return false;
  write_attribute(writer, "fmiVersion", "3.0");
  write_icon(writer);
  int *force = find_forces(program->model);
  struct Edge edge = {.count = fmi3_terminal_count(program)};
  if (edge.count > 0) xmlTextWriterStartElement(writer, BAD_CAST "Terminals");
  for (size_t i = 0; i < program->model->coordinates.count; i++) {
    if (!has_terminal(program, force, i)) continue;
    write_terminal(writer, program, force, i, &edge);
    edge.number++;
  }
  if (edge.count > 0) xmlTextWriterEndElement(writer);
  return close_document(writer);
}
