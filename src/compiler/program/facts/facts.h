/* What struct Lagrangian tells of a system beside its functions. */
#pragma once

#include "program/program.h"

/*
 * Without functions, the solver and other parts of the runtime, the name of the GUID, and what switches. work_count: what tables
 * need, 0 for statements.
 */
struct Lagrangian facts_of(const struct Program *program, size_t work_count);
