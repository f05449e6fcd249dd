/* Names of the symbols on which expressions depend, for messages. */
#pragma once

#include "algebra/graph.h"

/* Symbols by their indices in the graph, ascending. */
struct SymbolNames {
  size_t *symbols;
  size_t count;
};

/* Adds the symbols of count expressions. */
void symbol_names_add(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count);

/* Adds to names[i] the symbols of nodes[i]. Faster than one at a time, as each sweep treats 64 symbols. */
void symbol_names_add_each(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count);

/* Returns a list such as "m, l"; a long one ends with "...". */
char *symbol_names_text(const struct SymbolNames *names, const struct Graph *graph);
