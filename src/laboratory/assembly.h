/* Links a program to the runtime in memory, without a compiler. */
#pragma once

#include "program/program.h"

/* Makes the program the runtime's system; keeps guid. Returns NULL, or the name of a method that is not available. */
const char *assemble(const struct Program *program, const char *guid);
