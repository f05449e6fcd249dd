#include "program/metadata/inertia_names.h"

#include "base/memory.h"
#include "interface/symbol_names.h"

/* Names a block's dependences. The pivot of a row depends on the rows eliminated up to it. */
static void name_block(const struct Graph *graph, const struct InertiaBlock *block, size_t coordinates,
                       const char **texts) {
  struct SymbolNames names = {0};
  for (size_t i = 0; i < block->count && block->tree == NULL; i++) {
    if (block->coordinates[i] >= coordinates) continue;
    symbol_names_add(&names, graph, block->mass + block->start[i], block->start[i + 1] - block->start[i]);
    texts[block->coordinates[i]] = symbol_names_text(&names, graph);
  }
}

/* Names dependences in kinematic trees. The articulated inertia of a link depends on the links outward of it. */
static void name_pivots_of_trees(const struct Graph *graph, const struct Inertia *inertia, const char **texts) {
  const struct Pivot **pivots = allocate(inertia->pivot_count, sizeof(struct Pivot *));
  Node *values = allocate(inertia->pivot_count, sizeof *values);
  size_t count = 0;
  for (size_t i = 0; i < inertia->pivot_count; i++) {
    if (inertia_block_of(inertia, inertia->pivots[i].coordinate)->tree == NULL) continue;
    values[count] = inertia->pivots[i].value;
    pivots[count++] = &inertia->pivots[i];
  }
  struct SymbolNames *names = allocate(count, sizeof *names);
  symbol_names_add_each(names, graph, values, count);
  for (size_t i = 0; i < count; i++) texts[pivots[i]->coordinate] = symbol_names_text(&names[i], graph);
}

const char *const *inertia_names_of(const struct Program *program) {
  const struct Inertia *inertia = program->equations->inertia;
  size_t n = program->equations->count;
  if (n == 0) return NULL;
  const char **texts = allocate(n, sizeof *texts);
  for (size_t b = 0; b < inertia->block_count; b++) name_block(program->model->graph, &inertia->blocks[b], n, texts);
  name_pivots_of_trees(program->model->graph, inertia, texts);
  return texts;
}
