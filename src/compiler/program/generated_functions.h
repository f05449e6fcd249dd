/* The functions that lagc generates: declaration, field in struct Lagrangian, and builder of the instructions. */
#pragma once

#include "program/codegen/code_generator.h"

struct Program;

/* Functions with one instruction list come first, in the order in which they are built and written. */
enum FunctionName {
  FUNCTION_PREPARE,
  FUNCTION_INITIAL_STATE,
  FUNCTION_INITIAL_STATE_ALONG,
  FUNCTION_DERIVATIVES,
  FUNCTION_DIRECTIONAL,
  FUNCTION_WEIGHTED_GRADIENT,
  FUNCTION_JACOBIAN,
  FUNCTION_LINEAR,
  FUNCTION_ACCELERATIONS,
  FUNCTION_ACCELERATIONS_ALONG,
  FUNCTION_CORRECT_POSITIONS,
  FUNCTION_CORRECT_VELOCITIES,
  FUNCTION_RESPOND,
  FUNCTION_START_POSITIONS,
  FUNCTION_START_VELOCITIES,
  /* before: struct Lagrangian; from here on: struct SwitchTable, as statements unless switches_are_table */
  LAGRANGIAN_IR_FUNCTIONS,
  FUNCTION_INDICATORS = LAGRANGIAN_IR_FUNCTIONS,
  FUNCTION_ROUNDING_BOUNDS,
  FUNCTION_SWITCHING_VALUES,
  FUNCTION_RESTING_SUMS,
  FUNCTION_BALL_DISTANCES,
  IR_FUNCTION_COUNT, /* from here on: functions with several instruction lists, or one of several of their kind */
  FUNCTION_START = IR_FUNCTION_COUNT,
  FUNCTION_SERIES,
  FUNCTION_LIMIT,
  FUNCTION_OUTPUT_SERIES,
  FUNCTION_WATCHED_LIMIT,
  FUNCTION_RESULT,
  FUNCTION_RESULT_ALONG,
  FIELD_COUNT,
  FUNCTION_RESULTS = FIELD_COUNT, /* called by result() for a group of variables */
  FUNCTION_COUNT
};

/* The result of a generated function: none; 0 or 1 + a singular coordinate; a number. */
enum ReturnKind { RETURNS_NOTHING, RETURNS_STATUS, RETURNS_VALUE };

/* Where a function reads or leaves the accelerations: its workspace, the array that it fills, or an argument. */
enum Accelerations { IN_WORKSPACE, IN_TARGET, IN_ARGUMENT };

/* The struct that has the function's field: struct Lagrangian, a table in it, or struct SwitchTable. */
enum FunctionGroup { IN_LAGRANGIAN, IN_RESULTS, IN_TAYLOR, IN_IMPLICIT, IN_CONSTRAINTS, IN_SWITCHES };

/* A row of the table: the properties of a generated function. */
struct GeneratedFunction {
  const char *comment, *name;
  const char *arguments; /* the declared parameter list */
  const char *target;    /* the array argument that it fills; NULL if it returns a value */
  enum ReturnKind returned;
  enum Accelerations accelerations;
  enum FunctionGroup group;                         /* the struct that has its field, of the same name */
  bool (*is_needed)(const struct Program *program); /* true if the system needs it; NULL: every system does */
  /* Builds its instruction list; NULL for a function that has several. */
  struct IrFunction *(*build)(const struct Program *program, struct CodeGenerator *generator);
};

extern const struct GeneratedFunction generated_functions[FUNCTION_COUNT];

/* True if the program needs the function. */
bool has_function(const struct Program *program, enum FunctionName name);

/* Builds an instruction list that computes the nodes and copies them to the targets 0 .. count - 1. */
struct IrFunction *ir_of_targets(struct CodeGenerator *generator, const Node *nodes, size_t count);
