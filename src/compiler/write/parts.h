/*
 * Splits a long function into parts, each a function, since compile time grows faster than linearly with the length of
 * a function.
 */
#pragma once

#include "program/codegen/ir.h"

/* The space of values that several parts use: elements of the array s in point->work. */
enum { SPACE_SHARED = SPACE_COUNT };

/* The parts of a function, in the order of their calls. */
struct Parts {
  struct IrFunction **items;
  size_t count;
  size_t steady_count; /* number of first parts, which do not depend on the direction */
  size_t shared_count;
};

/*
 * Returns the parts; a single one if the function is short or works on blocks. accelerations: number of those in the
 * function's own workspace, which the parts share; 0 if they are in its target.
 */
struct Parts parts_of(struct IrFunction *ir, size_t accelerations);
