/* What brings a state back to the constraints, as instructions: see correct_positions in include/lagrangian.h. */
#pragma once

#include "program/program.h"

struct Routine *correct_positions_routine(const struct Program *program, struct Values *values);
struct Routine *correct_velocities_routine(const struct Program *program, struct Values *values);

/* The same where fixed coordinates stay where they are. */
struct Routine *start_positions_routine(const struct Program *program, struct Values *values);
struct Routine *start_velocities_routine(const struct Program *program, struct Values *values);

/* What impulses of contacts and frictions do: see respond in include/lagrangian.h. */
struct Routine *responses_routine(const struct Program *program, struct Values *values);
