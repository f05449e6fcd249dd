/* The tables of variables and the struct Lagrangian at the end of a generated file. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* The name of the system's struct Lu of the runtime, and of its file; NULL for none. */
const char *description_lu(const struct Program *program);

/* The name of the solver, and of its file; NULL for a system without coordinates. */
const char *description_solver(const struct Program *program);

/* work_count: as in struct Lagrangian. */
void description_write(FILE *file, const struct Program *program, size_t work_count);
