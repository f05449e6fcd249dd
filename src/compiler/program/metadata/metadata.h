/* Metadata of a system for struct Lagrangian. */
#pragma once

#include "program/program.h"

/*
 * Returns the struct without functions, parts of the runtime, GUID and switches. work_count: workspace of tables; 0
 * for statements.
 */
struct Lagrangian metadata_of(const struct Program *program, size_t work_count);
