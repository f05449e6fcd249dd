/* Blocks that events work in. They stay with the instance, so that steps allocate no memory once the largest was asked for. */
#ifndef SCRATCH_H
#define SCRATCH_H

#include <stdbool.h>
#include <stddef.h>

/* What works in a block of its own, one at a time. */
enum ScratchUse {
  SCRATCH_PUSHES,
  SCRATCH_IMPACT,
  SCRATCH_RESTING,
  SCRATCH_CONES,
  SCRATCH_FORCES,
  SCRATCH_LEVERS,
  SCRATCH_SHARES,
  SCRATCH_USES
};

struct Scratch {
  void *block;
  size_t size;
  bool is_taken;
};

struct Instance;

/* Zeros; NULL where there is no memory. */
void *scratch_take(struct Instance *instance, enum ScratchUse use, size_t size);
void scratch_return(struct Instance *instance, enum ScratchUse use);
void scratch_free(struct Instance *instance);

#endif
