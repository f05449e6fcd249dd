/* The program of an FMU: the instruction lists (struct IrFunction) of the functions in include/lagrangian.h. */
#pragma once

#include "program/expressions/accelerations.h"
#include "program/expressions/expressions.h"
#include "program/generated_functions.h"
#include "program/result_groups.h"
#include "program/series/series_program.h"

/*
 * The form of the generated code. BY_SIZE: small systems as C statements, large ones as instruction tables. TABLES:
 * tables except for the functions of struct SwitchTable. ALL_TABLES: tables for these too, for an interpreter.
 */
enum CodeForm { BY_SIZE, STATEMENTS, TABLES, ALL_TABLES };

/*
 * Loops for the middle terms of the Cauchy products in an order (include/series.h). There is one at each product,
 * one for all products, or one over an array of factor pairs.
 */
enum ProductForm { PRODUCTS_APART, PRODUCTS_TOGETHER, PRODUCTS_LISTED };

/* The program: instruction lists, and the choices between forms of code. */
struct Program {
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Expressions *expressions;
  struct ParameterConstants *parameter_constants;
  struct LoopedBlocks blocks;
  struct IrFunction *ir_functions[IR_FUNCTION_COUNT]; /* NULL for a function that the system does not need */
  struct ResultGroups groups;
  /*
   * result[]: the code of a group, at the result that leads it. result_along[]: the directional derivative of an
   * output or a calculated parameter. NULL for others.
   */
  struct IrFunction **result, **result_along;
  struct SeriesProgram *series, *output_series;
  struct SeriesProgram *watched_series; /* NULL without limits on the search for events */
  bool is_table;                        /* too long to compile quickly as statements, see program.c */
  /* The same for the functions in which a simulation spends its time. */
  bool derivatives_are_table, directional_is_table, series_is_table;
  bool switches_are_table;   /* the same for the functions of struct SwitchTable */
  enum ProductForm products; /* of one order of the series */
  const char *solver, *lu;   /* names and source files of the runtime's struct Solver and struct Lu; NULL without */
  struct StepWork work;      /* empty without a solver */
  struct OperationCounts operations; /* empty unless the method integrates by Taylor series */
};

/* Builds all instruction lists of a system and chooses their form. */
struct Program *program_create(const struct Expressions *expressions, enum CodeForm form);

/* True if the block has statements of its own: at most 3 rows, some of constraints, and a symmetric matrix. */
bool program_solves_by_statements(const struct Program *program, size_t block);

/* Calls visit for each instruction list and its function, in the order in which they are built. */
typedef void IrVisitor(void *context, enum FunctionName name, const struct IrFunction *ir);
void program_visit(const struct Program *program, IrVisitor *visit, void *context);

/* Returns the number of instructions of all functions except linear(), which only copies. */
size_t instruction_count(const struct Program *program);
