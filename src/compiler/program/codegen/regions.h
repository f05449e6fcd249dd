/*
 * Regions: instructions whose results only guards with one condition use. Where it is not positive, a table skips them:
 * for example the forces of a shape that touches nothing.
 */
#pragma once

#include "program/codegen/ir.h"

/* Instructions in their order, which are needed only where the condition is positive. */
struct Region {
  Slot condition;
  struct IrFunction ir;
};

/* A function's regions, and its other instructions with an instruction SKIP in place of each region. */
struct SeparatedFunction {
  struct IrFunction outer; /* the result of SKIP is the region's index, its operand the condition */
  struct Region *regions;
  size_t region_count;
};

/*
 * Find the conditions of the rows of a series, which its functions need in IrFunction.row_conditions. At first no row
 * has a use. Uses by others than the instructions of an order follow (condition: NULL if a row is always needed), and
 * at last those by these instructions.
 */
Slot *regions_rows_create(size_t count);
void regions_need_row(Slot *row_conditions, size_t row, const Slot *condition);
void regions_find_rows(const struct IrFunction *order, Slot *row_conditions, size_t row_count);

/* Separates the regions of the consecutive parts of a function; ends: of each part. */
void regions_separate(const struct IrFunction *ir, const size_t *ends, size_t count, struct SeparatedFunction *parts);

/* Frees what regions_separate() allocates. */
void regions_release(struct SeparatedFunction *parts, size_t count);

/* Returns the number of instructions in regions. */
size_t regions_length(const struct IrFunction *ir);
