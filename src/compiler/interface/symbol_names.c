#include "interface/symbol_names.h"

#include <stdint.h>
#include <string.h>

#include "algebra/cone.h"
#include "base/memory.h"

/* Bytes of a list: C guarantees literals of 4095, and shorter messages are easier to read. Symbols in a sweep. */
enum { LENGTH_LIMIT = 1000, WORD_BITS = 64 };

static void add_symbol(struct SymbolNames *names, size_t symbol) {
  size_t index = names->count;
  while (index > 0 && names->symbols[index - 1] > symbol) index--;
  if (index > 0 && names->symbols[index - 1] == symbol) return;
  names->symbols = make_room(names->symbols, names->count, sizeof *names->symbols);
  memmove(names->symbols + index + 1, names->symbols + index, (names->count - index) * sizeof *names->symbols);
  names->symbols[index] = symbol;
  names->count++;
}

void symbol_names_add(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count) {
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, nodes, count);
  for (size_t i = 0; i < cone->count; i++)
    if (graph->vertices[cone->nodes[i]].operation == SYMBOL) add_symbol(names, graph->vertices[cone->nodes[i]].left);
}

/*
 * Fills below: bit k of a member of the cone is set if it depends on the (first + k)-th symbol of the cone. Returns the
 * number of symbols.
 */
static size_t find_symbols_below(const struct Graph *graph, size_t first, uint64_t *below) {
  const struct Cone *cone = graph->cone;
  size_t symbols = 0;
  for (size_t index = 0; index < cone->count; index++) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[index]];
    int arity = operation_arity(vertex->operation);
    below[index] = arity > 0 ? below[cone_slot(cone, vertex->left)] : 0;
    if (arity == 2) below[index] |= below[cone_slot(cone, vertex->right)];
    if (vertex->operation != SYMBOL) continue;
    if (symbols >= first && symbols < first + WORD_BITS) below[index] = (uint64_t)1 << (symbols - first);
    symbols++;
  }
  return symbols;
}

static size_t *symbols_of_cone(const struct Graph *graph) {
  const struct Cone *cone = graph->cone;
  struct SymbolNames all = {0};
  for (size_t i = 0; i < cone->count; i++)
    if (graph->vertices[cone->nodes[i]].operation == SYMBOL) add_symbol(&all, graph->vertices[cone->nodes[i]].left);
  return all.symbols;
}

void symbol_names_add_each(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count) {
  const struct Cone *cone = graph->cone;
  cone_collect(graph->cone, graph, nodes, count);
  const size_t *symbols = symbols_of_cone(graph);
  uint64_t *below = allocate(cone->count, sizeof *below);
  for (size_t first = 0, end = 1; first < end; first += WORD_BITS) {
    end = find_symbols_below(graph, first, below);
    graph_work(graph, cone->count);
    for (size_t i = 0; i < count; i++)
      for (size_t k = 0; k < WORD_BITS; k++)
        if ((below[cone_slot(cone, nodes[i])] >> k & 1) != 0) add_symbol(&names[i], symbols[first + k]);
  }
}

char *symbol_names_text(const struct SymbolNames *names, const struct Graph *graph) {
  struct TextStream text;
  FILE *file = open_text(&text);
  size_t length = 0;
  for (size_t i = 0; i < names->count && length <= LENGTH_LIMIT; i++) {
    const char *name = graph->symbols[names->symbols[i]].name;
    const char *shown = length + strlen(name) <= LENGTH_LIMIT ? name : "...";
    fprintf(file, "%s%s", length > 0 ? ", " : "", shown);
    length += strlen(name) + 2;
  }
  return close_text(&text);
}
