/* A program laid out in memory, as a system that the runtime solves. */
#pragma once

#include "program/program.h"

/* Makes it the runtime's system; guid lasts as long. Returns NULL, or the name of a method that the laboratory does not have. */
const char *assemble(const struct Program *program, const char *guid);
