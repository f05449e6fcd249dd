/* Builders of functions of systems with constraints; see struct ConstraintTable in include/lagrangian.h. */
#pragma once

#include "program/program.h"

/* Builds the code of one function. */
typedef struct IrFunction *Builder(const struct Program *program, struct CodeGenerator *generator);

/* Projections onto the constraints, and those of the start values, where fixed coordinates keep theirs. */
Builder build_correct_positions, build_correct_velocities, build_start_positions, build_start_velocities;

/* The response of the velocities to impulses of contacts and frictions. */
Builder build_responses;

/*
 * Replaces, in the targets, the directional derivatives of constraint forces by those of the forces of least norm,
 * where constraints are redundant. The targets must hold one solution of the differentiated equations, and
 * SPACE_ACCELERATION the accelerations and least-norm forces at the point.
 */
void append_least_forces_along(const struct Program *program, struct CodeGenerator *generator);
