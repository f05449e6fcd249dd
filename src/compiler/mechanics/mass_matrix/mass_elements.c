#include "mechanics/mass_matrix/mass_elements.h"

#include <stdlib.h>

#include "algebra/differentiate.h"
#include "algebra/polynomials/shorten.h"
#include "base/memory.h"

static struct Elements elements_create(void) {
  return (struct Elements){.positions = make_room(NULL, 0, sizeof(struct Position)),
                           .nodes = make_room(NULL, 0, sizeof(Node))};
}

void elements_append(struct Elements *elements, size_t row, size_t column, Node node) {
  elements->positions = make_room(elements->positions, elements->count, sizeof *elements->positions);
  elements->nodes = make_room(elements->nodes, elements->count, sizeof *elements->nodes);
  elements->positions[elements->count] = (struct Position){row, column};
  elements->nodes[elements->count++] = node;
}

/* Computes M_ij = d p_i / d v_j by rows, j <= i. A prescribed coordinate has the row of v' = acceleration, 1. */
static struct Elements differentiate_momenta(const struct Model *model, const Node *momentum, const size_t *tree_of) {
  struct Graph *graph = model->graph;
  size_t count = model->coordinates.count;
  struct Elements elements = elements_create();
  for (size_t i = 0; i < count && graph_limit(graph) == NULL; i++) {
    if (tree_of[i] != NO_TREE) continue;
    if (model->prescribed.motions[i].is_prescribed) {
      elements_append(&elements, i, i, ONE);
      continue;
    }
    struct Gradient row = gradient_by_kinds(graph, momentum[i], 1u << VELOCITY);
    for (size_t k = 0; k < row.count; k++) {
      size_t j = (size_t)graph_symbol_of(graph, row.symbols[k])->index;
      if (j <= i && !model->prescribed.motions[j].is_prescribed) elements_append(&elements, i, j, row.values[k]);
    }
  }
  return elements;
}

static size_t root_of(size_t *parent, size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

struct ConnectedComponents find_components(size_t count, const struct Elements *elements) {
  struct ConnectedComponents components = {.of = allocate(count, sizeof(size_t))};
  size_t *parent = allocate(count, sizeof *parent);
  for (size_t i = 0; i < count; i++) parent[i] = i;
  for (size_t k = 0; k < elements->count; k++) {
    size_t a = root_of(parent, elements->positions[k].row), b = root_of(parent, elements->positions[k].column);
    parent[a > b ? a : b] = a > b ? b : a;
  }
  for (size_t i = 0; i < count; i++)
    components.of[i] = parent[i] == i ? components.count++ : components.of[root_of(parent, i)];
  return components;
}

size_t *sort_by_components(struct Elements *elements, const struct ConnectedComponents *components) {
  struct Elements sorted = elements_create();
  size_t *start = allocate(components->count + 1, sizeof *start), *next = allocate(elements->count, sizeof *next);
  size_t *first = allocate(components->count, sizeof *first);
  for (size_t k = elements->count; k-- > 0;) {
    size_t component = components->of[elements->positions[k].row];
    next[k] = first[component];
    first[component] = k + 1;
  }
  for (size_t component = 0; component < components->count; component++) {
    for (size_t k = first[component]; k > 0; k = next[k - 1])
      elements_append(&sorted, elements->positions[k - 1].row, elements->positions[k - 1].column,
                      elements->nodes[k - 1]);
    start[component + 1] = sorted.count;
  }
  *elements = sorted;
  return start;
}

/*
 * Computes elements by columns, in the order of parts: rows of parts are indices of positions. The expressions differ
 * from those by rows, with the same values.
 */
static void differentiate_columns(const struct Model *model, const Node *momentum, const struct Position *parts,
                                  const struct Position *positions, size_t count, Node *nodes) {
  struct Graph *graph = model->graph;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  Node *targets = allocate(count, sizeof *targets), *column = allocate(count, sizeof *column);
  for (size_t first = 0, end = 0; first < count && graph_limit(graph) == NULL; first = end) {
    for (end = first; end < count && parts[end].column == parts[first].column; end++)
      targets[end - first] = momentum[positions[parts[end].row].row];
    Node *seed = &seeds[graph->vertices[model->velocities.items[parts[first].column].node].left];
    *seed = ONE;
    derivative_along(graph, targets, end - first, seeds, column);
    *seed = ZERO;
    for (size_t k = first; k < end; k++) nodes[parts[k].row] = column[k - first];
  }
}

/*
 * Replaces the elements of a component by those of columns if these are shorter. Each column takes a sweep over all
 * momenta, so this is tried only if there are at least columns^2 / 4 elements.
 */
static void try_columns(const struct Model *model, const Node *momentum, const struct Position *positions, size_t count,
                        Node *nodes) {
  struct Position *parts = allocate(count, sizeof *parts);
  size_t columns = 0;
  for (size_t k = 0; k < count; k++) parts[k] = (struct Position){k, positions[k].column};
  qsort(parts, count, sizeof *parts, compare_positions);
  for (size_t k = 0; k < count; k++) columns += k == 0 || parts[k].column != parts[k - 1].column;
  if (columns > 1 && 4 * count >= columns * columns) {
    Node *others = allocate(count, sizeof *others);
    differentiate_columns(model, momentum, parts, positions, count, others);
    take_shorter(model->graph, count, nodes, others);
  }
}

/* Replaces the elements of each component by reduced fractions if these are shorter, and removes those that vanish. */
static void shorten_elements(const struct Model *model, const Node *momentum, struct Elements *elements) {
  struct ConnectedComponents components = find_components(model->coordinates.count, elements);
  size_t *start = sort_by_components(elements, &components), kept = 0;
  for (size_t component = 0; component < components.count; component++) {
    size_t first = start[component], count = start[component + 1] - first;
    try_columns(model, momentum, elements->positions + first, count, elements->nodes + first);
    shorten(model->graph, count, elements->nodes + first);
  }
  for (size_t k = 0; k < elements->count; k++) {
    if (elements->nodes[k] == ZERO) continue;
    elements->positions[kept] = elements->positions[k];
    elements->nodes[kept++] = elements->nodes[k];
  }
  elements->count = kept;
}

struct Elements elements_of(const struct Model *model, const Node *momentum, const size_t *tree_of) {
  struct Elements elements = differentiate_momenta(model, momentum, tree_of);
  shorten_elements(model, momentum, &elements);
  return elements;
}
