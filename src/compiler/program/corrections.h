/* Builds the code of the projection onto the constraints; see correct_positions in include/lagrangian.h. */
#pragma once

#include "program/program.h"

struct Routine *correct_positions_routine(const struct Program *program, struct Values *values);
struct Routine *correct_velocities_routine(const struct Program *program, struct Values *values);

/* Build the same for the start values, where coordinates with fixed start values keep them. */
struct Routine *start_positions_routine(const struct Program *program, struct Values *values);
struct Routine *start_velocities_routine(const struct Program *program, struct Values *values);

/* Builds the response of the velocities to impulses of contacts and frictions; see respond in include/lagrangian.h. */
struct Routine *responses_routine(const struct Program *program, struct Values *values);
