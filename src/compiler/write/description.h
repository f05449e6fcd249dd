/* The tables of variables and the struct Lagrangian at the end of a generated file. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* The fields of the program's functions that stand in these groups. */
void write_fields(FILE *file, const struct Program *program, enum FunctionGroup first, enum FunctionGroup last);

/* work_count: as in struct Lagrangian. */
void description_write(FILE *file, const struct Program *program, size_t work_count);
