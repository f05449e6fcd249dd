/* The order of a routine's instructions in a table: those of one run side by side, as far as their operands allow. */
#pragma once

#include "program/expressions/accelerations.h"

/* The numbers of the routine's instructions in the order of execution. */
size_t *schedule_create(const struct Routine *routine, const struct LoopedBlocks *blocks);

/* The spaces of the result and the operands, packed as in a table; an instruction's run has the same for all. */
uint32_t spaces_of(const struct Instruction *instruction);

/* Whether two instructions may stand in one run. */
bool same_run(const struct Instruction *first, const struct Instruction *second);
