/*
 * The functions of a system, carried out from tables in memory in place of generated C. There is one system, as in an FMU.
 */
#pragma once

#include "instructions.h"
#include "program/tables/encoding.h"

/* The runtime's `lagrangian` in the laboratory: its sources are compiled with this name for it. */
extern const struct Lagrangian *system_in_memory;

/* A check of limits for each of some functions. */
struct Limits {
  struct LimitCheck *checks;
  size_t count;
};

struct Interpreter {
  struct InstructionTables tables;
  const uint32_t *code[FUNCTION_COUNT];        /* of functions of one routine, and of series the coefficients 0 */
  const uint32_t *order[FUNCTION_COUNT];       /* of series: the coefficients k */
  struct RoutineTables results, results_along; /* as encode_all() made them */
  double *values;                              /* workspace for the targets of one of these */
  size_t coordinate_count, prepared_count;     /* without the locals of prepare() */
  size_t mass_row;                             /* as in struct SeriesProgram */
  struct Limits limits, watched_limits;
};

extern struct Interpreter interpreter;

/* Sets the functions of the program's system, which the interpreter carries out; switches: as pointed to from there, or NULL. */
void set_functions(struct Lagrangian *system, struct SwitchTable *switches, const struct Program *program);
