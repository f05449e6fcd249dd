/* What the runtime must know of what switches: struct SwitchTable of the generated code. */
#ifndef WRITE_SWITCHING_H
#define WRITE_SWITCHING_H

#include <stdio.h>

#include "program/program.h"

/* Nothing where nothing switches. */
void switching_write(FILE *file, const struct Program *program);

#endif
