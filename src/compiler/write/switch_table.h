/* Writes struct SwitchTable of the generated code: modes, events, contacts and frictions. */
#pragma once

#include <stdio.h>

#include "program/tables/encoding.h"

/* Writes nothing if the system has no modes. tables: NULL for a program of statements. */
void switching_write(FILE *file, const struct Program *program, const struct Encoding *tables);
