/* Metadata of the constraints for struct Lagrangian. */
#pragma once

#include "program/program.h"

/* Returns the table without its functions; empty without constraints. */
struct ConstraintTable constraint_metadata_of(const struct Program *program);
