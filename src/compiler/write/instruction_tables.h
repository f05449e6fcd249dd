/* Routines as tables of numbers, which instructions.h describes, and the functions that have them carried out. */
#pragma once

#include "write/function_text.h"

/* What the tables of a program refer to. */
struct TableContext {
  const struct Program *program;
  size_t *number; /* for each node: 1 + the place of a constant among the numbers, 0 for none */
  struct NodeList numbers;
  size_t function[OPERATION_COUNT]; /* 1 + the function's place among those with as many operands, 0 for none */
};

struct TableContext *table_context_create(const struct Program *program);

/* The numbers, functions and blocks that all tables share. */
void instruction_tables_shared(FILE *file, const struct TableContext *context);

/* The workspace that the tables need, as in struct Lagrangian. */
size_t instruction_tables_work_count(const struct TableContext *context);

/* A function of one routine. */
void instruction_tables_function(FILE *file, const struct TableContext *context, enum FunctionName name,
                                 const struct Routine *routine);

/* result() and result_along() */
void instruction_tables_results(FILE *file, const struct TableContext *context);

/* start(), series() and limit(). */
void instruction_tables_series(FILE *file, const struct TableContext *context);

/* output_series() */
void instruction_tables_output_series(FILE *file, const struct TableContext *context);
