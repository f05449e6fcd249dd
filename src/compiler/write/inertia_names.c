#include "write/inertia_names.h"

#include <stdlib.h>
#include <string.h>

#include "algebra/cone.h"
#include "memory.h"

/* C allows 4095 characters in a string, and a message has its use with fewer. */
enum { LENGTH_LIMIT = 1000 };

/* Symbols by their numbers in the graph, ascending. */
struct Names {
  size_t *symbols;
  size_t count;
};

static void add_symbol(struct Names *names, size_t symbol) {
  size_t place = names->count;
  while (place > 0 && names->symbols[place - 1] > symbol) place--;
  if (place > 0 && names->symbols[place - 1] == symbol) return;
  names->symbols = reallocate(names->symbols, names->count + 1, sizeof *names->symbols);
  memmove(names->symbols + place + 1, names->symbols + place, (names->count - place) * sizeof *names->symbols);
  names->symbols[place] = symbol;
  names->count++;
}

static char *text_of(const struct Graph *graph, const struct Names *names) {
  char *text = NULL;
  size_t size = 0, length = 0;
  FILE *file = open_text(&text, &size);
  for (size_t i = 0; i < names->count && length <= LENGTH_LIMIT; i++) {
    const char *name = graph->symbols[names->symbols[i]].name;
    const char *shown = length + strlen(name) <= LENGTH_LIMIT ? name : "...";
    fprintf(file, "%s%s", length > 0 ? ", " : "", shown);
    length += strlen(name) + 2;
  }
  fclose(file);
  return text;
}

/* The elimination of a row rests on the rows of the block up to it. */
static void name_block(const struct Graph *graph, struct Cone *cone, const struct InertiaBlock *block, char **texts) {
  struct Names names = {0};
  for (size_t i = 0; i < block->count; i++) {
    cone_collect(cone, graph, block->mass + block->start[i], block->start[i + 1] - block->start[i], NULL);
    for (size_t k = 0; k < cone->count; k++)
      if (graph->vertices[cone->nodes[k]].operation == SYMBOL) add_symbol(&names, graph->vertices[cone->nodes[k]].left);
    texts[block->coordinates[i]] = text_of(graph, &names);
  }
  free(names.symbols);
}

void inertia_names_write(FILE *file, const struct Program *program) {
  const struct Inertia *inertia = program->equations->inertia;
  size_t n = program->equations->count;
  if (n == 0) return;
  char **texts = allocate(n, sizeof *texts);
  struct Cone *cone = cone_create();
  for (size_t b = 0; b < inertia->block_count; b++) name_block(program->model->graph, cone, &inertia->blocks[b], texts);
  fputs("static const char *const inertia_depends_on[] = {\n", file);
  for (size_t i = 0; i < n; i++) {
    fprintf(file, "    \"%s\",\n", texts[i]);
    free(texts[i]);
  }
  fputs("};\n\n", file);
  cone_free(cone);
  free(texts);
}
