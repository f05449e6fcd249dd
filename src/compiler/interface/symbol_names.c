#include "interface/symbol_names.h"

#include <string.h>

#include "algebra/cone.h"
#include "base/memory.h"

/* C allows 4095 characters in a string, and a message has its use with fewer. */
enum { LENGTH_LIMIT = 1000 };

static void add_symbol(struct SymbolNames *names, size_t symbol) {
  size_t place = names->count;
  while (place > 0 && names->symbols[place - 1] > symbol) place--;
  if (place > 0 && names->symbols[place - 1] == symbol) return;
  names->symbols = make_room(names->symbols, names->count, sizeof *names->symbols);
  memmove(names->symbols + place + 1, names->symbols + place, (names->count - place) * sizeof *names->symbols);
  names->symbols[place] = symbol;
  names->count++;
}

void symbol_names_add(struct SymbolNames *names, const struct Graph *graph, const Node *nodes, size_t count) {
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, nodes, count, NULL);
  for (size_t i = 0; i < cone->count; i++)
    if (graph->vertices[cone->nodes[i]].operation == SYMBOL) add_symbol(names, graph->vertices[cone->nodes[i]].left);
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
