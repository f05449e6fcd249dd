/* Builds the code of the projection onto the constraints; see correct_positions in include/lagrangian.h. */
#pragma once

#include "program/program.h"

struct IrFunction *build_correct_positions(const struct Program *program, struct CodeGenerator *generator);
struct IrFunction *build_correct_velocities(const struct Program *program, struct CodeGenerator *generator);

/* Build the same for the start values, where coordinates with fixed start values keep them. */
struct IrFunction *build_start_positions(const struct Program *program, struct CodeGenerator *generator);
struct IrFunction *build_start_velocities(const struct Program *program, struct CodeGenerator *generator);

/* Builds the response of the velocities to impulses of contacts and frictions; see respond in include/lagrangian.h. */
struct IrFunction *build_responses(const struct Program *program, struct CodeGenerator *generator);
