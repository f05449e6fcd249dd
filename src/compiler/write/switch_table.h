/* What the runtime must know of what switches: struct SwitchTable of the generated code. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* Nothing where nothing switches. */
void switching_write(FILE *file, const struct Program *program);
