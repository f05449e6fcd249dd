/* The heads of the functions of the generated code, which both writers write. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* Whether the argument, as declared, is among those of the function. */
bool takes(enum FunctionName name, const char *argument);

/* The comment and the head of a function, up to its brace; suffix belongs to the name. */
void write_head(FILE *file, enum FunctionName name, const char *suffix, size_t operations);
