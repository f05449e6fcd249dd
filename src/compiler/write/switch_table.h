/* Writes struct SwitchTable of the generated code: modes, events, contacts and frictions. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* Writes nothing if the system has no modes. */
void switching_write(FILE *file, const struct Program *program);
