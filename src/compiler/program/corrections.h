/* What brings a state back to the constraints, as instructions: see correct_positions in include/lagrangian.h. */
#ifndef CORRECTIONS_H
#define CORRECTIONS_H

#include "program/program.h"

/* starting: fixed coordinates stay where they are. */
struct Routine *correct_positions_routine(const struct Program *program, struct Values *values, bool starting);
struct Routine *correct_velocities_routine(const struct Program *program, struct Values *values, bool starting);

/* What impulses of contacts and frictions do: see respond in include/lagrangian.h. */
struct Routine *responses_routine(const struct Program *program, struct Values *values);

#endif
