/* What the inertia of coordinates depends on, for messages. */
#pragma once

#include "program/program.h"

/* inertia_depends_on of struct Lagrangian; NULL without coordinates. */
const char *const *inertia_names_of(const struct Program *program);
