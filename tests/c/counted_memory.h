/* Memory functions for an FMU that count blocks, to detect leaks. */
#ifndef COUNTED_MEMORY_H
#define COUNTED_MEMORY_H

#include <stdlib.h>

static long blocks; /* allocated and not freed */

/* Returns zeroed memory; NULL if exhausted. */
static inline void *count_allocation(size_t count, size_t size) {
  void *block = calloc(count, size);
  if (block != NULL) blocks++;
  return block;
}

static inline void count_free(void *block) {
  if (block != NULL) blocks--;
  free(block);
}

#endif
