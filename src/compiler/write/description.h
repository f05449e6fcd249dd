/* The tables of variables and the struct Lagrangian at the end of a generated file. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* work_count: as in struct Lagrangian. */
void description_write(FILE *file, const struct Program *program, size_t work_count);
