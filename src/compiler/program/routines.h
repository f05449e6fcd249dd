/* The generated functions that are one routine each: a row for each of them says all but what the routine computes. */
#ifndef ROUTINES_H
#define ROUTINES_H

#include "program/values/values.h"

struct Program;

/* In the order in which they are built and written. */
enum RoutineName {
  ROUTINE_PREPARE,
  ROUTINE_INITIAL_STATE,
  ROUTINE_INITIAL_STATE_ALONG,
  ROUTINE_DERIVATIVES,
  ROUTINE_DIRECTIONAL,
  ROUTINE_JACOBIAN,
  ROUTINE_LINEAR,
  ROUTINE_ACCELERATIONS,
  ROUTINE_ACCELERATIONS_ALONG,
  ROUTINE_CORRECT_POSITIONS,
  ROUTINE_CORRECT_VELOCITIES,
  ROUTINE_RESPOND,
  ROUTINE_START_POSITIONS,
  ROUTINE_START_VELOCITIES,
  LAGRANGIAN_ROUTINES, /* those of struct Lagrangian; those of struct SwitchTable are statements always */
  ROUTINE_INDICATORS = LAGRANGIAN_ROUTINES,
  ROUTINE_SWITCHING_VALUES,
  ROUTINE_COUNT
};

enum Returned { RETURNS_NOTHING, RETURNS_STATUS, RETURNS_VALUE };

/* Where a function finds or leaves accelerations. */
enum Accelerations { IN_WORKSPACE, IN_TARGET, IN_ARGUMENT };

struct FunctionText {
  const char *comment, *name; /* the name is that of the field of struct Lagrangian too */
  const char *arguments;      /* as declared */
  const char *target;         /* the argument that it fills; NULL where a value is returned */
  enum Returned returned;
  enum Accelerations accelerations;
};

struct RoutineFacts {
  bool (*is_needed)(const struct Program *program); /* NULL: always */
  struct Routine *(*build)(const struct Program *program, struct Values *values);
  struct FunctionText text;
};

extern const struct RoutineFacts routine_facts[ROUTINE_COUNT];

/* A routine that computes nodes as its targets. */
struct Routine *targets_routine(struct Values *values, const Node *nodes, size_t count);

#endif
