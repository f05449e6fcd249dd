/* Writes the tables of variables and struct Lagrangian, which end a generated file. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* The names of enum VariableKind. */
extern const char *const variable_kind_names[];

/* Writes initializers of the function pointers in these groups. */
void write_functions_of(FILE *file, const struct Program *program, enum FunctionGroup first, enum FunctionGroup last);

/* Writes the tables and struct Lagrangian. work_count: length of Point.work that the functions need. */
void description_write(FILE *file, const struct Program *program, size_t work_count);
