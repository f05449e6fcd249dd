/* Writes the C file of a system: its program as functions, and the description that names them. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* The file refers to GUID, which the caller defines before it. */
void code_write(FILE *file, const struct Program *program);
