/* The functions of the generated code: a row for each, and what builds those of one routine. */
#pragma once

#include "program/values/values.h"

struct Program;

/* Those of one routine come first, in the order in which they are built and written. */
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
  LAGRANGIAN_ROUTINES, /* those of struct Lagrangian; those of struct SwitchTable are statements always */
  FUNCTION_INDICATORS = LAGRANGIAN_ROUTINES,
  FUNCTION_ROUNDINGS,
  FUNCTION_SWITCHING_VALUES,
  ROUTINE_COUNT, /* the others have several routines, or are one of many */
  FUNCTION_START = ROUTINE_COUNT,
  FUNCTION_SERIES,
  FUNCTION_LIMIT,
  FUNCTION_OUTPUT_SERIES,
  FUNCTION_WATCHED_LIMIT,
  FUNCTION_RESULT,
  FUNCTION_RESULT_ALONG,
  FIELD_COUNT,
  FUNCTION_RESULTS = FIELD_COUNT, /* which result() calls */
  FUNCTION_COUNT
};

enum Returned { RETURNS_NOTHING, RETURNS_STATUS, RETURNS_VALUE };

/* Where a function finds or leaves accelerations. */
enum Accelerations { IN_WORKSPACE, IN_TARGET, IN_ARGUMENT };

/* struct Lagrangian itself, a group of it, or struct SwitchTable. */
enum FunctionGroup { IN_LAGRANGIAN, IN_RESULTS, IN_TAYLOR, IN_IMPLICIT, IN_CONSTRAINTS, IN_SWITCHES };

struct GeneratedFunction {
  const char *comment, *name;
  const char *arguments; /* as declared */
  const char *target;    /* the argument that it fills; NULL where a value is returned */
  enum Returned returned;
  enum Accelerations accelerations;
  enum FunctionGroup group;                         /* where its field stands, which has its name */
  bool (*is_needed)(const struct Program *program); /* by a system; NULL where each does */
  /* Builds it, where it has one routine; NULL for the others. */
  struct Routine *(*build)(const struct Program *program, struct Values *values);
};

extern const struct GeneratedFunction generated_functions[FUNCTION_COUNT];

/* Of those that are not of one routine: where the program has what they consist of. */
bool has_function(const struct Program *program, enum FunctionName name);

/* A routine that computes nodes as its targets. */
struct Routine *targets_routine(struct Values *values, const Node *nodes, size_t count);
