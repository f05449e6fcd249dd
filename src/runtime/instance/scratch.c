#include "instance/scratch.h"

#include <string.h>

#include "instance/instance.h"

void *scratch_take(struct Instance *instance, enum ScratchUse use, size_t size) {
  struct Scratch *scratch = &instance->scratch[use];
  if (scratch->is_taken) return NULL;
  if (scratch->block == NULL || scratch->size < size) {
    if (scratch->block != NULL) instance->memory.free(scratch->block);
    scratch->block = instance->memory.allocate(1, size);
    scratch->size = scratch->block != NULL ? size : 0;
  } else {
    memset(scratch->block, 0, size);
  }
  scratch->is_taken = scratch->block != NULL;
  return scratch->block;
}

void scratch_return(struct Instance *instance, enum ScratchUse use) {
  instance->scratch[use].is_taken = false;
}

void scratch_free(struct Instance *instance) {
  for (int use = 0; use < SCRATCH_USES; use++)
    if (instance->scratch[use].block != NULL) instance->memory.free(instance->scratch[use].block);
}
