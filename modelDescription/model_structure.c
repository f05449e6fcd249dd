#include "model_structure.h"

#include <stdio.h>

#include "base/memory.h"
#include "base/sorting.h"
#include "interface/dependencies.h"
#include "xml_output.h"

/* The form of ModelStructure in a version of FMI. Kinds: outputs, derivatives, initial unknowns, event indicators. */
struct StructureForm {
  const char *groups[4];   /* element around the unknowns of each kind; NULL for none */
  const char *elements[4]; /* element of an unknown of each kind; NULL for a kind that is not listed */
  const char *key;         /* the attribute that names a variable */
  size_t first_key;        /* key of the first variable */
  bool has_arrays;
};

const struct StructureForm structure_of_fmi2 = {.groups = {"Outputs", "Derivatives", "InitialUnknowns"},
                                                .elements = {"Unknown", "Unknown", "Unknown"},
                                                .key = "index",
                                                .first_key = 1};
const struct StructureForm structure_of_fmi3 = {
    .elements = {"Output", "ContinuousStateDerivative", "InitialUnknown", "EventIndicator"},
    .key = "valueReference",
    .first_key = FIRST_REFERENCE,
    .has_arrays = true};

/* State while ModelStructure is written. Indices are those of the interface's variables. */
struct Structure {
  const struct StructureForm *form;
  xmlTextWriterPtr writer;
  const struct Interface *interface;
  const struct Graph *graph;
  struct Dependencies *dependencies;
  size_t *variable_of;       /* for each symbol: 1 + the index of its variable; 0 if it is not a known */
  size_t *indices;           /* workspace: indices of the knowns that one unknown depends on */
  enum Dependency *of_index; /* workspace, for each variable: the kind of dependency */
};

/*
 * True if unknowns may depend on the variable. Initial unknowns depend on time, inputs, and variables with
 * initial="exact": parameters, and modes and states that initialization does not compute (FMI 2.0.4, section 2.2.8;
 * FMI 3.0.2, section 2.4.8).
 */
static bool is_known(const struct InterfaceVariable *variable, bool initial) {
  switch (variable->entry.kind) {
  case VARIABLE_TIME:
  case VARIABLE_INPUT: return true;
  case VARIABLE_STATE: return !(initial && starts_nearby(variable));
  case VARIABLE_MODE: return initial && !starts_nearby(variable);
  case VARIABLE_PARAMETER: return initial;
  default: return false;
  }
}

/* Returns dependenciesKind; factors exist for Real variables only. */
static const char *kind_name(enum Dependency dependency, enum VariableType type, bool initial) {
  if (type != TYPE_REAL) return "dependent";
  if (dependency == CONSTANT_FACTOR) return "constant";
  return dependency == TUNABLE_FACTOR && !initial ? "tunable" : "dependent";
}

/* Returns the index of the array that the variable is an element of, or of the variable itself. */
static size_t index_of_whole(const struct Structure *structure, size_t index) {
  while (structure->form->has_arrays && structure->interface->variables[index].is_further_element) index--;
  return index;
}

/* Adds the dependencies of one scalar. Returns the number of indices in places. */
static size_t add_indices(const struct Structure *structure, size_t count, Node node, bool initial) {
  const struct Dependencies *dependencies = structure->dependencies;
  dependencies_find(structure->dependencies, node, initial);
  for (size_t i = 0; i < dependencies->count; i++) {
    size_t symbol = dependencies->symbols[i], index = structure->variable_of[symbol];
    if (index == 0 || !is_known(&structure->interface->variables[index - 1], initial)) continue;
    size_t whole = index_of_whole(structure, index - 1);
    enum Dependency *dependency = &structure->of_index[whole];
    if (*dependency == INDEPENDENT) structure->indices[count++] = whole;
    if (dependencies->of[symbol] > *dependency) *dependency = dependencies->of[symbol];
  }
  return count;
}

/* Adds all knowns of initialization as dependencies, ascending. Returns their number. */
static size_t find_all_indices(const struct Structure *structure) {
  const struct Interface *interface = structure->interface;
  size_t count = 0, variable_count = structure->form->has_arrays ? interface->count : interface->count_in_fmi2;
  for (size_t i = 0; i < variable_count; i++) {
    const struct Vertex *vertex = &structure->graph->vertices[interface->variables[i].node];
    bool is_known_here = vertex->operation == SYMBOL && structure->variable_of[vertex->left] == i + 1 &&
                         is_known(&interface->variables[i], true);
    if (!is_known_here || index_of_whole(structure, i) != i) continue;
    structure->of_index[i] = DEPENDENT;
    structure->indices[count++] = i;
  }
  return count;
}

/*
 * Finds the knowns that the unknown, with all its elements, depends on, ascending. Returns their number. With
 * constraints, which move start values, initial unknowns depend on all knowns, except for calculated parameters.
 */
static size_t find_indices(const struct Structure *structure, size_t unknown, bool initial) {
  const struct InterfaceVariable *variable = &structure->interface->variables[unknown];
  bool moves = structure->dependencies->equations->constraints->count > 0 && !is_calculated_parameter(&variable->entry);
  if (initial && moves) return find_all_indices(structure);
  size_t elements = structure->form->has_arrays && variable->array_count > 0 ? variable->array_count : 1, count = 0;
  for (size_t i = 0; i < elements; i++) count = add_indices(structure, count, variable[i].node, initial);
  sort_sizes(structure->indices, count);
  return count;
}

static void write_dependencies(const struct Structure *structure, size_t count, bool initial) {
  struct TextStream indices, kinds;
  FILE *indices_file = open_text(&indices), *kinds_file = open_text(&kinds);
  for (size_t i = 0; i < count; i++) {
    size_t index = structure->indices[i];
    enum VariableType type = structure->interface->variables[index].entry.type;
    fprintf(indices_file, "%s%zu", i > 0 ? " " : "", index + structure->form->first_key);
    fprintf(kinds_file, "%s%s", i > 0 ? " " : "", kind_name(structure->of_index[index], type, initial));
  }
  write_attribute(structure->writer, "dependencies", close_text(&indices));
  write_attribute(structure->writer, "dependenciesKind", close_text(&kinds));
}

/*
 * Longest list of dependencies, except for outputs. In a large coupled system each derivative depends on nearly all
 * states, and the lists would grow quadratically. Without a list, an unknown depends on all knowns (FMI 2.0.4, section
 * 2.2.8). Importers need the lists of outputs to find algebraic loops.
 */
enum { DEPENDENCY_LIMIT = 1000 };

/* Writes the element of one unknown. */
static void write_unknown(const struct Structure *structure, const char *element, size_t unknown, bool initial) {
  size_t count = find_indices(structure, unknown, initial);
  xmlTextWriterStartElement(structure->writer, BAD_CAST element);
  xmlTextWriterWriteFormatAttribute(structure->writer, BAD_CAST structure->form->key, "%zu",
                                    unknown + structure->form->first_key);
  if (count <= DEPENDENCY_LIMIT || structure->interface->variables[unknown].entry.is_output)
    write_dependencies(structure, count, initial);
  for (size_t i = 0; i < count; i++) structure->of_index[structure->indices[i]] = INDEPENDENT;
  xmlTextWriterEndElement(structure->writer);
}

static bool is_output(const struct InterfaceVariable *variable) {
  return variable->entry.is_output;
}

static bool is_derivative(const struct InterfaceVariable *variable) {
  return variable->entry.kind == VARIABLE_DERIVATIVE;
}

static bool is_indicator(const struct InterfaceVariable *variable) {
  return variable->entry.kind == VARIABLE_INDICATOR;
}

/* True if initialization computes the variable; other states keep the initial value that was set. */
static bool is_computed_initially(const struct InterfaceVariable *variable) {
  return is_unknown(&variable->entry) && (variable->entry.kind != VARIABLE_STATE || starts_nearby(variable));
}

static void write_unknowns(const struct Structure *structure, int kind,
                           bool (*belongs)(const struct InterfaceVariable *), bool initial) {
  const char *group = structure->form->groups[kind];
  if (structure->form->elements[kind] == NULL) return;
  bool open = group == NULL;
  for (size_t i = 0; i < structure->interface->count; i++) {
    if (!belongs(&structure->interface->variables[i]) || index_of_whole(structure, i) != i) continue;
    if (!open) xmlTextWriterStartElement(structure->writer, BAD_CAST group);
    open = true;
    write_unknown(structure, structure->form->elements[kind], i, initial);
  }
  if (open && group != NULL) xmlTextWriterEndElement(structure->writer);
}

void model_structure_write(xmlTextWriterPtr writer, const struct Program *program, const struct StructureForm *form) {
  const struct Interface *interface = program->interface;
  const struct Graph *graph = program->model->graph;
  struct Structure structure = {.form = form, .writer = writer, .interface = interface, .graph = graph};
  structure.dependencies = dependencies_create(program->model, program->equations);
  structure.variable_of = allocate(graph->symbol_count, sizeof *structure.variable_of);
  structure.indices = allocate(interface->count, sizeof *structure.indices);
  structure.of_index = allocate(interface->count, sizeof *structure.of_index);
  for (size_t i = 0; i < interface->count; i++) {
    const struct Vertex *vertex = &graph->vertices[interface->variables[i].node];
    const struct InterfaceVariable *variable = &interface->variables[i];
    if (vertex->operation == SYMBOL && (is_known(variable, false) || is_known(variable, true)))
      structure.variable_of[vertex->left] = i + 1;
  }
  xmlTextWriterStartElement(writer, BAD_CAST "ModelStructure");
  write_unknowns(&structure, 0, is_output, false);
  write_unknowns(&structure, 1, is_derivative, false);
  write_unknowns(&structure, 2, is_computed_initially, true);
  write_unknowns(&structure, 3, is_indicator, false);
  xmlTextWriterEndElement(writer);
}
