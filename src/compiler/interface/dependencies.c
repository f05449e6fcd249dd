#include "interface/dependencies.h"

#include "algebra/cone.h"
#include "base/memory.h"
#include "base/sorting.h"

/* Steps of graph_work() for a symbol in a list, which is sorted and written. */
enum { LIST_WORK = 10 };

/* Symbols by their indices in the graph, each once. */
struct SymbolList {
  size_t *numbers;
  size_t count;
};

struct Dependencies *dependencies_create(const struct Model *model, const struct Equations *equations) {
  const struct Graph *graph = model->graph;
  struct Dependencies *dependencies = allocate(1, sizeof *dependencies);
  *dependencies = (struct Dependencies){.model = model, .graph = graph, .equations = equations};
  dependencies->of = allocate(graph->symbol_count, sizeof *dependencies->of);
  dependencies->symbols = allocate(graph->symbol_count, sizeof *dependencies->symbols);
  dependencies->symbols_of_block = allocate(equations->inertia->block_count, sizeof *dependencies->symbols_of_block);
  return dependencies;
}

static void clear(struct Dependencies *dependencies) {
  for (size_t i = 0; i < dependencies->count; i++) dependencies->of[dependencies->symbols[i]] = INDEPENDENT;
  dependencies->count = 0;
}

static void note(struct Dependencies *dependencies, size_t symbol, enum Dependency kind) {
  if (dependencies->of[symbol] == INDEPENDENT) dependencies->symbols[dependencies->count++] = symbol;
  if (kind > dependencies->of[symbol]) dependencies->of[symbol] = kind;
}

/* Returns how an operation depends on one of its operands; other is the other operand. */
static enum Dependency step_of(const struct Graph *graph, enum Operation operation, Node other) {
  if (operation == ADD) return CONSTANT_FACTOR;
  if (operation != MULTIPLY) return DEPENDENT;
  if (graph_is_constant(graph, other)) return CONSTANT_FACTOR;
  return graph_is_constant_in_time(graph, other) ? TUNABLE_FACTOR : DEPENDENT;
}

/*
 * Adds the symbols below a node. kind: how the dependent value depends on the node. A path has the least favourable
 * dependency of its steps, and a symbol that of its paths.
 */
static void descend(struct Dependencies *dependencies, Node target, enum Dependency kind) {
  const struct Graph *graph = dependencies->graph;
  const struct Cone *cone = graph->cone;
  if (graph_limit(graph) != NULL) return;
  cone_collect(graph->cone, graph, &target, 1);
  enum Dependency *on = allocate(cone->count, sizeof *on);
  on[cone_slot(cone, target)] = kind;
  for (size_t index = cone->count; index-- > 0;) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[index]];
    int arity = operation_arity(vertex->operation);
    if (vertex->operation == SYMBOL) note(dependencies, vertex->left, on[index]);
    for (int i = 0; i < arity; i++) {
      Node operand = i == 0 ? vertex->left : vertex->right, other = i == 0 ? vertex->right : vertex->left;
      enum Dependency *below = &on[cone_slot(cone, operand)];
      *below = (enum Dependency)larger(*below, larger(on[index], step_of(graph, vertex->operation, other)));
    }
  }
}

/* Returns the symbols in all residuals of a block; the list is made once. */
static const struct SymbolList *symbols_of(struct Dependencies *dependencies, size_t number) {
  const struct Graph *graph = dependencies->graph;
  const struct InertiaBlock *block = &dependencies->equations->inertia->blocks[number];
  struct SymbolList *list = &dependencies->symbols_of_block[number];
  if (list->numbers != NULL) return list;
  Node *residuals = allocate(block->count, sizeof *residuals);
  for (size_t i = 0; i < block->count; i++) residuals[i] = dependencies->equations->residual[block->coordinates[i]];
  cone_collect(graph->cone, graph, residuals, block->count);
  list->numbers = allocate(graph->symbol_count, sizeof *list->numbers);
  for (size_t index = 0; index < graph->cone->count; index++) {
    const struct Vertex *vertex = &graph->vertices[graph->cone->nodes[index]];
    if (vertex->operation == SYMBOL && (vertex->kinds & 1u << ACCELERATION) == 0)
      list->numbers[list->count++] = vertex->left;
  }
  return list;
}

/* Adds the symbols on which an acceleration depends, for a value that depends on it by kind. */
static void follow_acceleration(struct Dependencies *dependencies, size_t coordinate, enum Dependency kind) {
  const struct Equations *equations = dependencies->equations;
  if (graph_limit(dependencies->graph) != NULL) return;
  const struct InertiaBlock *block = inertia_block_of(equations->inertia, coordinate);
  if (block->is_unrolled && block->tree == NULL) {
    descend(dependencies, equations->acceleration[coordinate], kind);
    return;
  }
  const struct SymbolList *list = symbols_of(dependencies, equations->inertia->block_of[coordinate]);
  graph_work(dependencies->graph, LIST_WORK * list->count);
  for (size_t i = 0; i < list->count; i++) note(dependencies, list->numbers[i], DEPENDENT);
}

/* Returns the state or declared mode of a symbol; NULL for other symbols. */
static const struct Variable *started_variable(const struct Model *model, const struct Symbol *symbol) {
  switch (symbol->kind) {
  case COORDINATE: return &model->coordinates.items[symbol->index];
  case VELOCITY: return &model->velocities.items[symbol->index];
  case STATE: return &model->states.items[symbol->index];
  default: break;
  }
  for (size_t i = 0; symbol->kind == MODE && i < model->modes.count; i++)
    if (model->modes.items[i].node == symbol->node) return &model->modes.items[i];
  return NULL;
}

/* Adds the symbols in start values of the states and modes that were found. */
static void follow_starts(struct Dependencies *dependencies) {
  const struct Model *model = dependencies->model;
  size_t found = dependencies->count;
  for (size_t i = 0; i < found; i++) {
    size_t number = dependencies->symbols[i];
    const struct Variable *started = started_variable(model, &dependencies->graph->symbols[number]);
    if (started != NULL && start_follows(model, started))
      descend(dependencies, started->start_expression, dependencies->of[number]);
  }
}

void dependencies_find(struct Dependencies *dependencies, Node node, bool initial) {
  const struct Graph *graph = dependencies->graph;
  clear(dependencies);
  descend(dependencies, node, CONSTANT_FACTOR);
  size_t direct = dependencies->count;
  for (size_t i = 0; i < direct; i++) {
    const struct Symbol *symbol = &graph->symbols[dependencies->symbols[i]];
    if (symbol->kind != ACCELERATION) continue;
    follow_acceleration(dependencies, (size_t)symbol->index, dependencies->of[dependencies->symbols[i]]);
  }
  if (initial) follow_starts(dependencies);
}
