/* One instruction as one C statement, with the names that the functions around it declare. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* An operand, or a result, in its role; target is the name of what SPACE_TARGET is. */
void write_place(FILE *file, const struct Program *program, Place place, enum Role role, const char *target);

/* The statements of a routine; without a target, values for it are returned. */
void write_statements(FILE *file, const struct Program *program, const struct Routine *routine, const char *target);
