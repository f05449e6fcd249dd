/* Writes the generated C file. */
#ifndef EMIT_H
#define EMIT_H

#include <stdio.h>

#include "program/program.h"

/* Writes system.c; guid identifies model and equations. */
void emit_system(FILE *file, const struct Program *program, const char *guid);

#endif
