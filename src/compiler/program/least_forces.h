/* Directional derivatives of the constraint forces of least norm, where constraints are redundant, as instructions. */
#pragma once

#include "program/program.h"

/*
 * Replaces, in the targets, the directional derivatives of constraint forces by those of the forces of least norm. The
 * targets must hold one solution of the differentiated equations, and SPACE_ACCELERATION the accelerations and
 * least-norm forces at the point.
 */
void append_least_forces_along(const struct Program *program, struct CodeGenerator *generator);
