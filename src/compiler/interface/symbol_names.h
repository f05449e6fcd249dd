/* The names of the symbols that expressions depend on, as a list for messages. */
#pragma once

#include "algebra/graph.h"

/* Symbols by their numbers in the graph, ascending. */
struct SymbolNames {
  size_t *symbols;
  size_t count;
};

/* Adds those of count expressions. */
void symbol_names_add(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count);

/* Adds to names[i] those of nodes[i], which have much in common: cheaper than one after the other. */
void symbol_names_add_each(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count);

/* "m, l"; a long list ends with "...". */
char *symbol_names_text(const struct SymbolNames *names, const struct Graph *graph);
