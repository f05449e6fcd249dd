/* What the inertia of coordinates depends on, for messages. */
#pragma once

#include <stdio.h>

#include "program/program.h"

/* The array inertia_depends_on of the generated file. */
void inertia_names_write(FILE *file, const struct Program *program);
