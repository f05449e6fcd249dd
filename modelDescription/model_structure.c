#include "model_structure.h"

#include <stdlib.h>

#include "memory.h"
#include "xml_output.h"

struct Structure {
  xmlTextWriterPtr writer;
  const struct Interface *interface;
  enum Dependency **of; /* for each variable: the dependency of every node on it, NULL where it is no known */
};

static bool is_known(const struct ScalarVariable *entry, bool initial) {
  return entry->kind == VARIABLE_TIME || entry->kind == VARIABLE_STATE || entry->kind == VARIABLE_INPUT ||
         (initial && entry->kind == VARIABLE_PARAMETER);
}

static const char *kind_name(enum Dependency dependency, bool initial) {
  if (dependency == CONSTANT_FACTOR) return "constant";
  return dependency == TUNABLE_FACTOR && !initial ? "tunable" : "dependent";
}

/* The element for one unknown. Among initial unknowns, parameters are knowns too. */
static void write_unknown(const struct Structure *structure, size_t unknown, bool initial) {
  const struct Interface *interface = structure->interface;
  xmlBufferPtr places = xmlBufferCreate(), kinds = xmlBufferCreate();
  const char *separator = "";
  for (size_t i = 0; i < interface->count; i++) {
    if (!is_known(&interface->variables[i].entry, initial)) continue;
    enum Dependency dependency = structure->of[i][interface->variables[unknown].node];
    if (dependency == INDEPENDENT) continue;
    char *place = format_text("%s%zu", separator, i + 1);
    xmlBufferCCat(places, place);
    free(place);
    xmlBufferCCat(kinds, separator);
    xmlBufferCCat(kinds, kind_name(dependency, initial));
    separator = " ";
  }
  xmlTextWriterStartElement(structure->writer, BAD_CAST "Unknown");
  xmlTextWriterWriteFormatAttribute(structure->writer, BAD_CAST "index", "%zu", unknown + 1);
  write_attribute(structure->writer, "dependencies", (const char *)xmlBufferContent(places));
  write_attribute(structure->writer, "dependenciesKind", (const char *)xmlBufferContent(kinds));
  xmlTextWriterEndElement(structure->writer);
  xmlBufferFree(places);
  xmlBufferFree(kinds);
}

static bool is_output(const struct ScalarVariable *entry) {
  return entry->is_output;
}

static bool is_derivative(const struct ScalarVariable *entry) {
  return entry->kind == VARIABLE_DERIVATIVE;
}

/* Outputs and derivatives that initialisation computes; states have the initial value that was set. */
static bool is_initial_unknown(const struct ScalarVariable *entry) {
  return is_derivative(entry) || (entry->is_output && entry->kind == VARIABLE_RESULT);
}

static void write_unknowns(const struct Structure *structure, const char *element,
                           bool (*belongs)(const struct ScalarVariable *), bool initial) {
  bool open = false;
  for (size_t i = 0; i < structure->interface->count; i++) {
    if (!belongs(&structure->interface->variables[i].entry)) continue;
    if (!open) xmlTextWriterStartElement(structure->writer, BAD_CAST element);
    open = true;
    write_unknown(structure, i, initial);
  }
  if (open) xmlTextWriterEndElement(structure->writer);
}

void model_structure_write(xmlTextWriterPtr writer, const struct Model *model, const struct Equations *equations,
                           const struct Interface *interface) {
  struct Structure structure = {writer, interface, allocate(interface->count, sizeof *structure.of)};
  for (size_t i = 0; i < interface->count; i++)
    if (is_known(&interface->variables[i].entry, true) && interface->variables[i].node != ZERO)
      structure.of[i] = dependencies_on(model->graph, equations, interface->variables[i].node);
    else structure.of[i] = allocate(model->graph->count, sizeof **structure.of);
  xmlTextWriterStartElement(writer, BAD_CAST "ModelStructure");
  write_unknowns(&structure, "Outputs", is_output, false);
  write_unknowns(&structure, "Derivatives", is_derivative, false);
  write_unknowns(&structure, "InitialUnknowns", is_initial_unknown, true);
  xmlTextWriterEndElement(writer);
  for (size_t i = 0; i < interface->count; i++) free(structure.of[i]);
  free(structure.of);
}
