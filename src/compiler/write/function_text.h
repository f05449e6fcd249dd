/* Writes the heads of generated functions, for statements and tables alike. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* True if the declared parameters of the function contain this text. */
bool takes(enum FunctionName name, const char *argument);

/* Writes the comment and the head of a function up to its brace; suffix extends the name. */
void write_head(FILE *file, enum FunctionName name, const char *suffix, size_t operations);
