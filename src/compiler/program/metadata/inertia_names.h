/* The parameters and coordinates that inertias depend on, for messages. */
#pragma once

#include "program/program.h"

/* Returns inertia_depends_on of struct Lagrangian; NULL without coordinates. */
const char *const *inertia_names_of(const struct Program *program);
