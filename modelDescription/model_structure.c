#include "model_structure.h"

#include <stdio.h>
#include <stdlib.h>

#include "mechanics/dependencies.h"
#include "memory.h"
#include "xml_output.h"

struct Structure {
  xmlTextWriterPtr writer;
  const struct Interface *interface;
  struct Dependencies *dependencies;
  size_t *place_of; /* of the variable of each symbol: 1 + its place among the variables; 0 where it is no known */
  size_t *places;   /* workspace: of what one unknown depends on */
};

/* Symbols that an unknown may depend on. Among initial unknowns, parameters are knowns too. */
static bool is_known(const struct ScalarVariable *entry, bool initial) {
  return entry->kind == VARIABLE_TIME || entry->kind == VARIABLE_INPUT ||
         (entry->kind == VARIABLE_STATE && !(initial && has_following_start(entry))) ||
         (initial && entry->kind == VARIABLE_PARAMETER);
}

/* Factors are of Real variables alone. */
static const char *kind_name(enum Dependency dependency, enum VariableType type, bool initial) {
  if (type != TYPE_REAL) return "dependent";
  if (dependency == CONSTANT_FACTOR) return "constant";
  return dependency == TUNABLE_FACTOR && !initial ? "tunable" : "dependent";
}

static int compare(const void *first, const void *second) {
  size_t a = *(const size_t *)first, b = *(const size_t *)second;
  return (a > b) - (a < b);
}

/* The places of the knowns that the unknown depends on, in no particular order; returns their number. */
static size_t find_places(const struct Structure *structure, size_t unknown, bool initial) {
  const struct Dependencies *dependencies = structure->dependencies;
  size_t count = 0;
  dependencies_find(structure->dependencies, structure->interface->variables[unknown].node, initial);
  for (size_t i = 0; i < dependencies->count; i++) {
    size_t place = structure->place_of[dependencies->symbols[i]];
    if (place > 0 && is_known(&structure->interface->variables[place - 1].entry, initial))
      structure->places[count++] = place - 1;
  }
  return count;
}

static void write_dependencies(const struct Structure *structure, size_t count, bool initial) {
  const struct Graph *graph = structure->dependencies->graph;
  char *places = NULL, *kinds = NULL;
  size_t places_length = 0, kinds_length = 0;
  qsort(structure->places, count, sizeof *structure->places, compare);
  FILE *places_file = open_text(&places, &places_length), *kinds_file = open_text(&kinds, &kinds_length);
  for (size_t i = 0; i < count; i++) {
    const struct InterfaceVariable *known = &structure->interface->variables[structure->places[i]];
    enum Dependency dependency = structure->dependencies->of[graph->vertices[known->node].left];
    fprintf(places_file, "%s%zu", i > 0 ? " " : "", structure->places[i] + 1);
    fprintf(kinds_file, "%s%s", i > 0 ? " " : "", kind_name(dependency, known->entry.type, initial));
  }
  close_text(places_file, &places, &places_length);
  close_text(kinds_file, &kinds, &kinds_length);
  write_attribute(structure->writer, "dependencies", places);
  write_attribute(structure->writer, "dependenciesKind", kinds);
  free(places);
  free(kinds);
}

/*
 * A derivative of a large coupled system depends on nearly all states, so that the lists of all of them would grow as
 * their square. Without a list it depends on all knowns (section 2.2.8). Outputs keep theirs: importers find algebraic
 * loops by them. Where constraints move the start values, all that is computed initially depends on all of them.
 */
enum { DEPENDENCY_LIMIT = 1000 };

/* The element for one unknown. */
static void write_unknown(const struct Structure *structure, size_t unknown, bool initial) {
  size_t count = find_places(structure, unknown, initial);
  xmlTextWriterStartElement(structure->writer, BAD_CAST "Unknown");
  xmlTextWriterWriteFormatAttribute(structure->writer, BAD_CAST "index", "%zu", unknown + 1);
  bool is_solved_for = initial && structure->dependencies->equations->constraints->count > 0;
  if (!is_solved_for && (count <= DEPENDENCY_LIMIT || structure->interface->variables[unknown].entry.is_output))
    write_dependencies(structure, count, initial);
  xmlTextWriterEndElement(structure->writer);
}

static bool is_output(const struct InterfaceVariable *variable) {
  return variable->entry.is_output;
}

static bool is_derivative(const struct InterfaceVariable *variable) {
  return variable->entry.kind == VARIABLE_DERIVATIVE;
}

/* What initialisation computes; other states have the initial value that was set. */
static bool is_computed_initially(const struct InterfaceVariable *variable) {
  return is_unknown(&variable->entry) && (variable->entry.kind != VARIABLE_STATE || starts_nearby(variable));
}

static void write_unknowns(const struct Structure *structure, const char *element,
                           bool (*belongs)(const struct InterfaceVariable *), bool initial) {
  bool open = false;
  for (size_t i = 0; i < structure->interface->count; i++) {
    if (!belongs(&structure->interface->variables[i])) continue;
    if (!open) xmlTextWriterStartElement(structure->writer, BAD_CAST element);
    open = true;
    write_unknown(structure, i, initial);
  }
  if (open) xmlTextWriterEndElement(structure->writer);
}

void model_structure_write(xmlTextWriterPtr writer, const struct Model *model, const struct Equations *equations,
                           const struct Interface *interface) {
  const struct Graph *graph = model->graph;
  struct Structure structure = {.writer = writer, .interface = interface};
  structure.dependencies = dependencies_create(model, equations);
  structure.place_of = allocate(graph->symbol_count, sizeof *structure.place_of);
  structure.places = allocate(interface->count, sizeof *structure.places);
  for (size_t i = 0; i < interface->count; i++) {
    const struct Vertex *vertex = &graph->vertices[interface->variables[i].node];
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    if (vertex->operation == SYMBOL && (is_known(entry, false) || is_known(entry, true)))
      structure.place_of[vertex->left] = i + 1;
  }
  xmlTextWriterStartElement(writer, BAD_CAST "ModelStructure");
  write_unknowns(&structure, "Outputs", is_output, false);
  write_unknowns(&structure, "Derivatives", is_derivative, false);
  write_unknowns(&structure, "InitialUnknowns", is_computed_initially, true);
  xmlTextWriterEndElement(writer);
  dependencies_free(structure.dependencies);
  free(structure.place_of);
  free(structure.places);
}
