/* Metadata of the blocks that are factored at run time, for instruction tables. */
#pragma once

#include "program/program.h"

/* The numbers of a block's rows, as coordinate[] of saddle.h and nonsymmetric.h. */
struct BlockNumbers {
  int *items;
  size_t count;
};

/*
 * Returns the numbers of a block's rows: 1 + index of coordinates, and those of saddle.h for constraints; see also
 * nonsymmetric.h.
 */
struct BlockNumbers block_numbers_of(const struct InertiaBlock *block, const struct Model *model);
