/* Workspace of event handling. Blocks stay with the instance, so that steps allocate no memory in the long run. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The users; each has a block of its own. */
enum ScratchUse {
  SCRATCH_IMPULSES,
  SCRATCH_IMPACT,
  SCRATCH_RESTING,
  SCRATCH_CONES,
  SCRATCH_FORCES,
  SCRATCH_RESTS,
  SCRATCH_USES
};

/* A block that grows on demand. It is used by one caller at a time. */
struct Scratch {
  void *block;
  size_t size;
  bool is_taken;
};

struct Instance;

/* Returns size bytes of zeros; NULL without memory, or if the block is in use. */
void *scratch_take(struct Instance *instance, enum ScratchUse use, size_t size);
void scratch_return(struct Instance *instance, enum ScratchUse use);
void scratch_free(struct Instance *instance);
