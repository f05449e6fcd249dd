/* Writes the C file of a system: its functions, and struct Lagrangian, which refers to them. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* Writes the file. It uses the macro GUID, which the caller must define before it. */
void code_write(FILE *file, const struct Program *program);
