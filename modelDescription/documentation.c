#include "documentation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/xmlwriter.h>

#include "algebra/differentiate.h"
#include "memory.h"
#include "algebra/formula.h"
#include "algebra/rational.h"
#include "algebra/simplify.h"
#include "xml_output.h"

static const char *const style =
    "body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
    "code{display:block;background:#f4f4f4;padding:.5em;margin:.3em 0;white-space:pre-wrap;overflow-wrap:anywhere}"
    "table{border-collapse:collapse}td,th{border-bottom:1px solid #ccc;padding:.2em .8em;text-align:left}";

static void element(xmlTextWriterPtr writer, const char *name, const char *text) {
  xmlTextWriterWriteElement(writer, BAD_CAST name, BAD_CAST text);
}

/* The expression as it is, or multiplied out where that is shorter. */
static char *readable_text(struct Graph *graph, Node node) {
  char *text = expression_text(graph, node), *expanded = expression_text(graph, simplify_fraction(graph, node));
  bool shorter = strlen(expanded) < strlen(text);
  free(shorter ? text : expanded);
  return shorter ? expanded : text;
}

/* left = expression, on a line of its own. */
static void write_equation(xmlTextWriterPtr writer, struct Graph *graph, const char *left, Node right) {
  char *expression = readable_text(graph, right), *text = format_text("%s = %s", left, expression);
  element(writer, "code", text);
  free(text);
  free(expression);
}

/* Row i of M a = right side, or the acceleration itself. */
static void write_motion(xmlTextWriterPtr writer, const struct Program *program, size_t i) {
  const struct Equations *equations = program->equations;
  struct Graph *graph = program->model->graph;
  if (equations->explicit_form) {
    char *left = format_text("der(%s)", program->model->velocities.items[i].name);
    write_equation(writer, graph, left, equations->acceleration[i]);
    free(left);
    return;
  }
  Node inertia = ZERO;
  for (size_t j = 0; j < equations->count; j++)
    inertia = add(graph, inertia,
                  multiply(graph, equations->mass[i * equations->count + j], program->model->accelerations[j]));
  char *left = readable_text(graph, inertia);
  write_equation(writer, graph, left, equations->right_side[i]);
  free(left);
}

/* Which law totalEnergy obeys (see energies.h). */
static const char *balance_of(const struct Model *model) {
  struct Graph *graph = model->graph;
  Node difference = subtract(graph, model->kinetic.node, model->potential.node); /* L */
  bool autonomous = simplify_fraction(graph, derivative_by(graph, difference, model->time)) == ZERO;
  if (!model->driven && autonomous)
    return model->has_forces
               ? "totalEnergy changes by the work of the non-conservative forces alone: its derivative is P."
               : "totalEnergy is constant.";
  if (!model->driven)
    return "L depends on time explicitly: the derivative of totalEnergy is the power of the non-conservative forces "
           "less the partial derivative dL/dt, so that totalEnergy is not constant even without forces.";
  if (autonomous)
    return "Masses are moved in a given way: totalEnergy is the energy K + U that they have. What moves them does "
           "work, so that totalEnergy is not constant even without forces. Jacobi's integral, the sum of v dL/dv "
           "less L, is another quantity here: its derivative is the sum of the generalized forces times the "
           "velocities v, so that it is constant without forces.";
  return "Masses are moved in a given way: totalEnergy is the energy K + U that they have. What moves them does work, "
         "so that totalEnergy is not constant even without forces. Jacobi's integral, the sum of v dL/dv less L, is "
         "another quantity here: its derivative is the sum of the generalized forces times the velocities v, less the "
         "partial derivative dL/dt, so that it is not constant either.";
}

static void write_energies(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Equations *equations = program->equations;
  const struct Model *model = program->model;
  bool linearized = model->linearized, separate = !linearized && model->kinetic.node != equations->kinetic;
  element(writer, "h2", "Energies");
  if (separate) write_equation(writer, model->graph, "T", model->kinetic.node);
  write_equation(writer, model->graph, "K", equations->kinetic);
  write_equation(writer, model->graph, "U", linearized ? equations->potential : model->potential.node);
  element(writer, "p", separate ? "The Lagrangian is L = T - U." : "The Lagrangian is L = K - U.");
  if (linearized) return;
  element(writer, "p",
          "kineticEnergy is K: half of mass times squared velocity of every body, and for each <kinetic> term T the "
          "term itself where it is a quadratic polynomial of the velocities v, else the sum of v dT/dv less T. "
          "potentialEnergy is U less the sum of v dU/dv, which is U where it has no velocities. totalEnergy is the "
          "sum of both.");
  element(writer, "p", balance_of(model));
}

static void write_mechanics(xmlTextWriterPtr writer, const struct Program *program) {
  const struct Equations *equations = program->equations;
  struct Graph *graph = program->model->graph;
  write_energies(writer, program);
  element(writer, "h2", "Equations of motion");
  for (size_t i = 0; i < equations->count; i++) write_motion(writer, program, i);
  if (!program->model->has_forces) return;
  element(writer, "h2", "Power of the non-conservative forces");
  write_equation(writer, graph, "P", equations->power);
  element(writer, "p",
          "It is the sum of force times velocity over the generalized forces and the dissipation, and of F . dr/dt "
          "over the Cartesian forces, where dr/dt is the whole velocity of the point they act on.");
}

static void write_outputs(xmlTextWriterPtr writer, const struct Model *model) {
  if (model->outputs.count == 0) return;
  element(writer, "h2", "Outputs");
  for (size_t i = 0; i < model->outputs.count; i++)
    write_equation(writer, model->graph, model->outputs.items[i].name, model->outputs.items[i].node);
}

static void write_variable_row(xmlTextWriterPtr writer, const struct InterfaceVariable *variable) {
  static const char *const kinds[] = {
      [VARIABLE_TIME] = "time",           [VARIABLE_STATE] = "state",         [VARIABLE_DERIVATIVE] = "derivative",
      [VARIABLE_INPUT] = "input",         [VARIABLE_PARAMETER] = "parameter", [VARIABLE_RESULT] = "computed",
      [VARIABLE_STATISTIC] = "statistic",
  };
  const struct ScalarVariable *entry = &variable->entry;
  char start[NUMBER_LENGTH] = "";
  if (!isnan(entry->start)) number_text(entry->start, start);
  const char *kind = entry->is_output && entry->kind == VARIABLE_RESULT ? "output" : kinds[entry->kind];
  xmlTextWriterStartElement(writer, BAD_CAST "tr");
  element(writer, "td", entry->name);
  element(writer, "td", kind);
  element(writer, "td", variable->unit != NULL ? variable->unit : "");
  element(writer, "td", start);
  element(writer, "td", variable->description != NULL ? variable->description : "");
  xmlTextWriterEndElement(writer);
}

static void write_variables(xmlTextWriterPtr writer, const struct Interface *interface) {
  static const char *const headings[] = {"name", "kind", "unit", "start", "description"};
  element(writer, "h2", "Variables");
  xmlTextWriterStartElement(writer, BAD_CAST "table");
  xmlTextWriterStartElement(writer, BAD_CAST "tr");
  for (size_t i = 0; i < 5; i++) element(writer, "th", headings[i]);
  xmlTextWriterEndElement(writer);
  for (size_t i = 0; i < interface->count; i++) write_variable_row(writer, &interface->variables[i]);
  xmlTextWriterEndElement(writer);
}

static void write_solver(xmlTextWriterPtr writer, const struct Program *program) {
  if (program->equations->count == 0) return;
  element(writer, "h2", "Solver");
  element(writer, "p", program->interface->method->sentence);
  if (!isnan(program->model->max_step)) {
    char *text = format_text("No step of the method is longer than %g s.", program->model->max_step);
    element(writer, "p", text);
    free(text);
  } else if (program->interface->method->series == FIRST_TERMS)
    element(writer, "p",
            "Each step is so short that no function in the equations can hide a narrow hill, wall or pulse, as far as "
            "the first three terms of their Taylor series tell; maxStep in system.xml bounds the steps further.");
}

bool documentation_write(xmlBufferPtr buffer, const struct Program *program) {
  const struct Model *model = program->model;
  xmlTextWriterPtr writer = xmlNewTextWriterMemory(buffer, 0);
  if (writer == NULL) return false;
  xmlTextWriterWriteDTD(writer, BAD_CAST "html", NULL, NULL, NULL);
  xmlTextWriterStartElement(writer, BAD_CAST "html");
  xmlTextWriterStartElement(writer, BAD_CAST "head");
  xmlTextWriterStartElement(writer, BAD_CAST "meta");
  write_attribute(writer, "charset", "utf-8");
  xmlTextWriterEndElement(writer);
  element(writer, "title", model->name);
  element(writer, "style", style);
  xmlTextWriterEndElement(writer);
  xmlTextWriterStartElement(writer, BAD_CAST "body");
  element(writer, "h1", model->name);
  if (model->description != NULL) element(writer, "p", model->description);
  if (program->equations->count > 0) write_mechanics(writer, program);
  write_outputs(writer, model);
  write_solver(writer, program);
  write_variables(writer, program->interface);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
  bool written = xmlTextWriterEndDocument(writer) >= 0;
  xmlFreeTextWriter(writer);
  return written;
}
