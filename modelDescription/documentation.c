#include "documentation.h"

#include <math.h>
#include <string.h>

#include <libxml/xmlwriter.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "mathml.h"
#include "xml_output.h"

static const char *const style =
    "body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
    "code{display:block;background:#f4f4f4;padding:.5em;margin:.3em 0;white-space:pre-wrap;overflow-wrap:anywhere}"
    "math{font-size:1.1em;max-width:100%;overflow-x:auto}.formula{margin:.8em 0 0;line-height:2.4}"
    "summary{color:#888;font-size:.8em}"
    "table{border-collapse:collapse}td,th{border-bottom:1px solid #ccc;padding:.2em .8em;text-align:left}";

static void element(xmlTextWriterPtr writer, const char *name, const char *text) {
  xmlTextWriterWriteElement(writer, BAD_CAST name, BAD_CAST text);
}

/* What the page is made of. */
struct Page {
  xmlTextWriterPtr writer;
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Summary *summary;
};

/* left = expression, typeset, and as text to copy. */
static void write_equation(const struct Page *page, const char *left, Node right) {
  char *expression = expression_text_with_names(page->model->graph, right, &page->summary->names);
  char *text = format_text("%s = %s", left, expression);
  char *math = mathml_of_equation(text);
  if (math != NULL) {
    xmlTextWriterStartElement(page->writer, BAD_CAST "p");
    write_attribute(page->writer, "class", "formula");
    xmlTextWriterWriteRaw(page->writer, BAD_CAST math);
    xmlTextWriterEndElement(page->writer);
    xmlTextWriterStartElement(page->writer, BAD_CAST "details");
    element(page->writer, "summary", "as text");
  }
  element(page->writer, "code", text);
  if (math != NULL) xmlTextWriterEndElement(page->writer);
}

/* Says how many of the things of a kind the page leaves out. */
static void write_rest(xmlTextWriterPtr writer, size_t count, size_t shown, const char *things) {
  if (count == shown) return;
  element(writer, "p", format_text("%zu further %s are not shown.", count - shown, things));
}

/* Which law totalEnergy obeys (see energies.h). */
static const char *balance_of(const struct Model *model, bool autonomous) {
  if (model->given.constraint != NULL)
    return "A constraint moves in a given way: its force does work, so that totalEnergy is not constant even without "
           "other forces.";
  if (!model->energies.driven && autonomous)
    return model->forces.any
               ? "totalEnergy changes by the work of the non-conservative forces alone: its derivative is P."
               : "totalEnergy is constant.";
  if (!model->energies.driven)
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

static void write_energies(const struct Page *page) {
  xmlTextWriterPtr writer = page->writer;
  const struct Summary *summary = page->summary;
  bool linearized = page->model->linearized;
  bool separate = !linearized && page->model->energies.kinetic.node != page->equations->kinetic;
  element(writer, "h2", "Energies");
  if (separate) write_equation(page, "T", summary->lagrangian_kinetic);
  write_equation(page, "K", summary->kinetic);
  write_equation(page, "U", summary->potential);
  element(writer, "p", separate ? "The Lagrangian is L = T - U." : "The Lagrangian is L = K - U.");
  if (linearized) return;
  element(writer, "p",
          "kineticEnergy is K: half of mass times squared velocity of every body, and for each <kinetic> term T the "
          "term itself where it is a quadratic polynomial of the velocities v, else the sum of v dT/dv less T. "
          "potentialEnergy is U less the sum of v dU/dv, which is U where it has no velocities. totalEnergy is the "
          "sum of both.");
  element(writer, "p", balance_of(page->model, summary->is_autonomous));
}

/* The author's own names, which the formulas use where they can. */
static void write_definitions(const struct Page *page) {
  const struct VariableList *definitions = &page->model->definitions;
  const struct NodeNames *names = &page->summary->names;
  bool first = true;
  for (size_t i = 0; i < definitions->count; i++) {
    const struct Variable *definition = &definitions->items[i];
    if (names->of[definition->node] != definition->name) continue;
    if (first) element(page->writer, "h2", "Definitions");
    first = false;
    write_equation(page, definition->name, definition->node);
  }
}

static void write_calculated(const struct Page *page) {
  const struct VariableList *calculated = &page->model->calculated;
  size_t shown = calculated->count < SHOWN_LIMIT ? calculated->count : SHOWN_LIMIT;
  if (shown == 0) return;
  element(page->writer, "h2", "Calculated parameters");
  for (size_t i = 0; i < shown; i++) write_equation(page, calculated->items[i].name, calculated->items[i].node);
  write_rest(page->writer, calculated->count, shown, "parameters");
}

static void write_reactions(const struct Page *page) {
  const struct VariableList *reactions = &page->model->reactions;
  if (reactions->count == 0) return;
  element(page->writer, "h2", "Forces of reaction");
  for (size_t i = 0; i < page->summary->reaction_count; i++)
    write_equation(page, reactions->items[i].name, page->summary->reactions[i]);
  write_rest(page->writer, reactions->count, page->summary->reaction_count, "forces");
  element(
      page->writer, "p",
      "The force along a displacement is what the system pushes with against what holds it, from Lagrange's "
      "equation of the displacement with the displacement at 0: the tension of a rod that it makes longer. The "
      "force of what drives a coordinate is what the drive pushes with, from Lagrange's equation of the coordinate.");
}

/* Start values that follow from parameters. */
static void write_starts(const struct Page *page) {
  const struct VariableList *const lists[] = {&page->model->coordinates, &page->model->velocities};
  size_t count = 0;
  for (size_t list = 0; list < 2; list++)
    for (size_t i = 0; i < lists[list]->count; i++) {
      const struct Variable *state = &lists[list]->items[i];
      if (!start_follows(page->model, state)) continue;
      if (count++ == 0) element(page->writer, "h2", "Start values, of what is not set before the simulation");
      if (count <= SHOWN_LIMIT) write_equation(page, state->name, state->start_expression);
    }
  write_rest(page->writer, count, count < SHOWN_LIMIT ? count : SHOWN_LIMIT, "start values");
}

static void write_constraints(const struct Page *page) {
  const struct VariableList *constraints = &page->model->constraints;
  size_t shown = constraints->count < SHOWN_LIMIT ? constraints->count : SHOWN_LIMIT;
  if (shown == 0) return;
  element(page->writer, "h2", "Constraints");
  for (size_t i = 0; i < shown; i++) write_equation(page, constraints->items[i].name, constraints->items[i].node);
  write_rest(page->writer, constraints->count, shown, "constraints");
  element(
      page->writer, "p",
      "Each is 0 at all times. Its force F stands on the left of the equations of motion with the derivatives of the "
      "constraint by the coordinates, or of one with velocities by these: it is a tension where the constraint is a "
      "distance less a length. After each step of the solver the state is brought back to the constraints.");
}

static void write_mechanics(const struct Page *page) {
  xmlTextWriterPtr writer = page->writer;
  const struct Summary *summary = page->summary;
  write_energies(page);
  write_constraints(page);
  element(writer, "h2", "Equations of motion");
  for (size_t i = 0; i < summary->motion_count; i++) {
    char *left = expression_text_with_names(page->model->graph, summary->inertial[i], &summary->names);
    write_equation(page, left, summary->right_side[i]);
  }
  write_rest(writer, page->equations->count, summary->motion_count, "equations");
  write_reactions(page);
  if (!page->model->forces.any) return;
  element(writer, "h2", "Power of the non-conservative forces");
  write_equation(page, "P", summary->power);
  element(writer, "p",
          "It is the sum of force times velocity over the generalized forces and the dissipation, and of F . dr/dt "
          "over the Cartesian forces, where dr/dt is the whole velocity of the point they act on; also of what drives "
          "coordinates and of what moves the points that depend on inputs.");
}

static void write_outputs(const struct Page *page) {
  const struct VariableList *outputs = &page->model->outputs;
  if (outputs->count == 0) return;
  element(page->writer, "h2", "Outputs");
  for (size_t i = 0; i < page->summary->output_count; i++)
    write_equation(page, outputs->items[i].name, page->summary->outputs[i]);
  write_rest(page->writer, outputs->count, page->summary->output_count, "outputs");
}

static void write_variable_row(xmlTextWriterPtr writer, const struct InterfaceVariable *variable) {
  static const char *const kinds[] = {
      [VARIABLE_TIME] = "time",           [VARIABLE_STATE] = "state",         [VARIABLE_DERIVATIVE] = "derivative",
      [VARIABLE_INPUT] = "input",         [VARIABLE_PARAMETER] = "parameter", [VARIABLE_RESULT] = "computed",
      [VARIABLE_STATISTIC] = "statistic", [VARIABLE_MODE] = "mode",           [VARIABLE_CONTACT] = "mode",
  };
  const struct ScalarVariable *entry = &variable->entry;
  char start[NUMBER_LENGTH] = "";
  if (entry->type == TYPE_BOOLEAN) snprintf(start, sizeof start, "%s", entry->start == 0.0 ? "false" : "true");
  else if (!isnan(entry->start)) number_text(entry->start, start);
  const char *kind = is_calculated_parameter(entry)                       ? "calculated parameter"
                     : entry->is_output && entry->kind == VARIABLE_RESULT ? "output"
                                                                          : kinds[entry->kind];
  xmlTextWriterStartElement(writer, BAD_CAST "tr");
  element(writer, "td", entry->name);
  element(writer, "td", kind);
  element(writer, "td", variable->unit != NULL ? variable->unit : "");
  element(writer, "td", start);
  element(writer, "td", variable->description != NULL ? variable->description : "");
  xmlTextWriterEndElement(writer);
}

enum { ROW_LIMIT = 1000 };

static void write_variables(xmlTextWriterPtr writer, const struct Interface *interface) {
  static const char *const headings[] = {"name", "kind", "unit", "start", "description"};
  element(writer, "h2", "Variables");
  xmlTextWriterStartElement(writer, BAD_CAST "table");
  xmlTextWriterStartElement(writer, BAD_CAST "tr");
  for (size_t i = 0; i < 5; i++) element(writer, "th", headings[i]);
  xmlTextWriterEndElement(writer);
  size_t count = interface->count_in_fmi2, rows = count < ROW_LIMIT ? count : ROW_LIMIT;
  for (size_t i = 0; i < rows; i++) write_variable_row(writer, &interface->variables[i]);
  xmlTextWriterEndElement(writer);
  write_rest(writer, count, rows, "variables, which modelDescription.xml has,");
}

static void write_solver(const struct Page *page) {
  xmlTextWriterPtr writer = page->writer;
  const struct Method *method = page->equations->method;
  if (page->equations->count == 0) return;
  element(writer, "h2", "Solver");
  element(writer, "p", method->sentence);
  if (!isnan(page->model->solver.max_step)) {
    element(writer, "p", format_text("No step of the method is longer than %g s.", page->model->solver.max_step));
  } else if (method->series == FIRST_TERMS)
    element(writer, "p",
            "Each step is so short that no function in the equations can hide a narrow hill, wall or pulse, as far as "
            "the first three terms of their Taylor series tell; maxStep in system.xml bounds the steps further.");
}

/* Small systems are compiled, large ones interpreted: see program.h. */
static void write_form(xmlTextWriterPtr writer, const struct Program *program) {
  bool only_series = program->is_table && program->series != NULL && !program->series_is_table;
  const char *form = only_series ? "those of the Taylor series as compiled C code, the others in tables, which the "
                                   "FMU carries out"
                     : program->is_table ? "in tables, which the FMU carries out: a C compiler would take long for them"
                                         : "as compiled C code";
  char *text = format_text("The equations are %zu instructions, %s.", instruction_count(program), form);
  element(writer, "h2", "Code");
  element(writer, "p", text);
}

/* model.png, which src/icon draws: of a system with frames, a sketch of its start. */
static void write_sketch(xmlTextWriterPtr writer, const struct Model *model) {
  bool has_frames = false;
  for (size_t i = 1; i < model->mechanism.frame_count; i++) has_frames |= !model->mechanism.frames[i].is_of_body;
  if (!has_frames) return;
  xmlTextWriterStartElement(writer, BAD_CAST "p");
  xmlTextWriterStartElement(writer, BAD_CAST "img");
  write_attribute(writer, "src", "../model.png");
  write_attribute(writer, "alt", "the frames and bodies at the start, with the way of the last of them");
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
}

bool documentation_write(xmlBufferPtr buffer, const struct Program *program, const struct Summary *summary) {
  const struct Model *model = program->model;
  const struct Equations *equations = program->equations;
  const struct Interface *interface = program->interface;
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
  write_sketch(writer, model);
  const struct Page page = {writer, model, equations, interface, summary};
  write_calculated(&page);
  write_definitions(&page);
  write_starts(&page);
  if (equations->count > 0) write_mechanics(&page);
  write_outputs(&page);
  write_solver(&page);
  write_form(writer, program);
  write_variables(writer, interface);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
  bool written = xmlTextWriterEndDocument(writer) >= 0;
  xmlFreeTextWriter(writer);
  return written;
}
