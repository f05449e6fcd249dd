/*
 * The functions of struct Lagrangian, executed from tables instead of generated C, for the one system of the process.
 */
#pragma once

#include "instructions.h"
#include "program/tables/encoding.h"

/* The runtime's sources are compiled with this name in place of `lagrangian`. */
extern const struct Lagrangian *system_in_memory;

/* The conditions that limit a step. */
struct Limits {
  struct LimitCheck *checks;
  size_t count;
};

/* The tables of a system, and their workspace. */
struct Interpreter {
  struct InstructionTables tables;
  /* the instruction table of each function; of a series: the table for the coefficients of order 0 */
  const int32_t *code[FUNCTION_COUNT];
  const int32_t *order[FUNCTION_COUNT];               /* of a series: the table for the coefficients of order k */
  struct IrTables results, results_along;             /* from encode_all() */
  double *values;                                     /* workspace for the targets of a table of results */
  size_t coordinate_count, parameter_constants_count; /* the latter without the local variables of prepare() */
  size_t mass_row;                                    /* see struct SeriesProgram */
  struct Limits limits, watched_limits;
};

extern struct Interpreter interpreter;

/* Sets the functions that the program has, in system and switches; NULL for others. switches may be NULL. */
void set_functions(struct Lagrangian *system, struct SwitchTable *switches, const struct Program *program);
