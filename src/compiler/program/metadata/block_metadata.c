#include "program/metadata/block_metadata.h"

#include "base/memory.h"

struct BlockNumbers block_numbers_of(const struct InertiaBlock *block, size_t coordinates) {
  size_t forces = block->force_count > 0 ? block->force_count + 1 : 0, count = 0;
  int *numbers = allocate(block->count + forces, sizeof *numbers);
  for (size_t i = 0; i < block->count; i++) {
    size_t row = block->coordinates[i];
    numbers[count++] = row < coordinates ? (int)row + 1 : (int)coordinates - (int)row - 1;
  }
  if (block->force_count > 0) numbers[count++] = (int)block->force_count;
  for (size_t k = 0; k < block->force_count; k++) numbers[count++] = (int)block->forces[k];
  return (struct BlockNumbers){numbers, count};
}
