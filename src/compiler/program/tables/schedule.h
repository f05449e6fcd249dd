/*
 * The order of a function's instructions in a table: long runs of equal instructions, as far as data dependences allow.
 */
#pragma once

#include "program/codegen/regions.h"
#include "program/expressions/accelerations.h"
#include "program/tables/forms.h"

/* Returns the indices of the instructions outside of regions, in the order of execution. */
size_t *schedule_create(const struct SeparatedFunction *function, const struct LoopedBlocks *blocks,
                        const struct Forms *forms);

/* Returns the spaces of result and operands, packed as in a table; equal for all instructions of a run. */
uint32_t spaces_of(const struct Instruction *instruction);

/* True if two instructions may be in one run. */
bool same_run(const struct Instruction *first, const struct Instruction *second);
