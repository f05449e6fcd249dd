/* What struct Lagrangian tells of constraints. */
#pragma once

#include "program/program.h"

/* Without the functions; empty for a system without constraints. */
struct ConstraintTable constraint_facts_of(const struct Program *program);
