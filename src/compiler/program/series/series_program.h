/*
 * Taylor series as instructions: one routine for the coefficients 0, one for the coefficients k of all series. Nodes
 * whose coefficients are needed again have a row of the workspace; of the others, only coefficient k is there.
 */
#pragma once

#include "program/expressions/accelerations.h"
#include "program/expressions/expressions.h"
#include "program/series/limits.h"

struct SeriesProgram {
  struct Routine *start; /* of the motion: d state / dt too */
  struct Routine *order;
  struct LimitChecks limit;
  size_t row_count;
  size_t mass_row;         /* where the factors of large blocks begin */
  size_t acceleration_row; /* where those of accelerations begin, as many as acceleration_count */
  size_t acceleration_count;
  size_t recurrences; /* in an order */
};

/* For the motion. */
struct SeriesProgram *series_program_of_motion(const struct Expressions *expressions, const struct LoopedBlocks *blocks,
                                               struct Values *values);

/* For the outputs, which are the first results; the accelerations are the derivatives of the velocities. */
struct SeriesProgram *series_program_of_outputs(const struct Expressions *expressions, struct Values *values);

/*
 * For the limits of what events look at, as far as they need series; the rows of the accelerations and forces are given. NULL
 * where nothing limits them.
 */
struct SeriesProgram *series_program_of_watched(const struct Expressions *expressions, struct Values *values);
