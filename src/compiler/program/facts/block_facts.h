/* What tables tell of large blocks of the mass matrix. */
#pragma once

#include "program/program.h"

struct BlockNumbers {
  int *items;
  size_t count;
};

/* The numbers of a block's coordinates, from 1 on, and negative ones of its constraints, from -1 on; see also oblique.h. */
struct BlockNumbers block_numbers_of(const struct InertiaBlock *block, size_t coordinates);
