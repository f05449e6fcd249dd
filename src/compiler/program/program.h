/* The program of an FMU: the routines that the functions of include/lagrangian.h consist of. */
#pragma once

#include "program/expressions/accelerations.h"
#include "program/expressions/expressions.h"
#include "program/generated_functions.h"
#include "program/result_groups.h"
#include "program/series/series_program.h"

/*
 * How the instructions are written; BY_SIZE: small systems as statements, large ones as tables; ALL_TABLES: what switches
 * too, for a program that carries them out itself.
 */
enum CodeForm { BY_SIZE, STATEMENTS, TABLES, ALL_TABLES };

/* How the middle terms of products are computed (include/series.h): each where it stands, all in one loop, or from a list. */
enum ProductForm { PRODUCTS_APART, PRODUCTS_TOGETHER, PRODUCTS_LISTED };

struct Program {
  const struct Model *model;
  const struct Equations *equations;
  const struct Interface *interface;
  const struct Expressions *expressions;
  struct Prepared *prepared;
  struct LoopedBlocks blocks;
  struct Routine *routines[ROUTINE_COUNT]; /* NULL where a system needs none */
  struct ResultGroups groups;
  /* Of each result that leads a group, for the whole group; along by itself, NULL unless it is an output. */
  struct Routine **result, **result_along;
  struct SeriesProgram *series, *output_series;
  struct SeriesProgram *watched_series; /* NULL where events look at nothing that can hide */
  bool is_table;                        /* as a whole too large for statements, which a C compiler takes long for */
  /* So are those parts of the motion in which a simulation spends its time. */
  bool derivatives_are_table, directional_is_table, series_is_table;
  bool switches_are_table;   /* so are the functions of struct SwitchTable */
  enum ProductForm products; /* of an order of the series */
  const char *solver, *lu; /* names of struct Solver and struct Lu of the runtime, and of their files; NULL for none */
  struct StepWork work;    /* where there is a solver */
  struct OperationCounts operations; /* where it hands over */
};

struct Program *program_create(const struct Expressions *expressions, enum CodeForm form);

/* Whether the solutions of a block are statements: it has few rows, of which one is a constraint's. */
bool program_solves_by_statements(const struct Program *program, size_t block);

/* Visits each routine of the program, with the function that it is of, in the order in which they are built. */
typedef void RoutineVisitor(void *context, enum FunctionName name, const struct Routine *routine);
void program_visit(const struct Program *program, RoutineVisitor *visit, void *context);

/* How many instructions all routines have together, but those of linear(), which copies alone. */
size_t instruction_count(const struct Program *program);
