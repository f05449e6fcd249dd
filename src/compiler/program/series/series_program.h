/*
 * Taylor series as instructions: start computes the coefficients 0, order the coefficients k >= 1 of all series. Nodes
 * whose lower coefficients are needed again have a row of the workspace; others keep coefficient k only.
 */
#pragma once

#include "program/expressions/accelerations.h"
#include "program/expressions/expressions.h"
#include "program/series/limits.h"

/* The instruction lists of a set of series, and their workspace. */
struct SeriesProgram {
  struct IrFunction *start; /* of the motion: also computes d state / dt */
  struct IrFunction *order;
  struct LimitChecks limit;
  size_t row_count;
  size_t mass_row;         /* first row of the factors of K */
  size_t acceleration_row; /* first of acceleration_count rows of accelerations and forces */
  size_t acceleration_count;
  size_t recurrences; /* number of recurrences in an order */
};

/* Returns the program of the motion. */
struct SeriesProgram *series_program_of_motion(const struct Expressions *expressions, const struct LoopedBlocks *blocks,
                                               struct CodeGenerator *generator);

/* Returns the program of the outputs, which are the first results. Accelerations are derivatives of the velocities. */
struct SeriesProgram *series_program_of_outputs(const struct Expressions *expressions, struct CodeGenerator *generator);

/* Returns the program of the limits on the search for events, given accelerations and forces; NULL without limits. */
struct SeriesProgram *series_program_of_watched(const struct Expressions *expressions, struct CodeGenerator *generator);
