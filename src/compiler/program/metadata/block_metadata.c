#include "program/metadata/block_metadata.h"

#include "base/memory.h"
#include "saddle.h"

static int number_of(const struct Model *model, size_t row) {
  if (row < model->coordinates.count) return (int)row + 1;
  return model->constraints.items[row - model->coordinates.count].is_norm ? SADDLE_NORM : SADDLE_CONSTRAINT;
}

struct BlockNumbers block_numbers_of(const struct InertiaBlock *block, const struct Model *model) {
  size_t forces = block->force_count > 0 ? block->force_count + 1 : 0, count = 0;
  int *numbers = allocate(block->count + forces, sizeof *numbers);
  for (size_t i = 0; i < block->count; i++) numbers[count++] = number_of(model, block->coordinates[i]);
  if (block->force_count > 0) numbers[count++] = (int)block->force_count;
  for (size_t k = 0; k < block->force_count; k++) numbers[count++] = (int)block->forces[k];
  return (struct BlockNumbers){numbers, count};
}
