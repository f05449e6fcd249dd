/* Routines as tables of numbers, which include/instructions.h describes. */
#pragma once

#include "program/program.h"

/* What the tables of a program refer to. */
struct Encoding {
  const struct Program *program;
  size_t *number; /* for each node: 1 + the place of a constant among the numbers, 0 for none */
  struct NodeList numbers;
  size_t function[OPERATION_COUNT]; /* 1 + the function's place among those with as many operands, 0 for none */
  size_t local_count;               /* of the routine that has most, but for those that have locals of their own */
};

struct Encoding *encoding_create(const struct Program *program);

/* The workspace that the tables need, as in struct Lagrangian. */
size_t encoding_work_count(const struct Encoding *encoding);

/* The words of some tables. */
struct Words {
  uint32_t *items;
  size_t count;
};

/* Appends the table of a routine, with its END. */
void encode(const struct Encoding *encoding, const struct Routine *routine, struct Words *words);

/* The tables of some routines, of which several may be NULL, one after the other. */
struct RoutineTables {
  struct Words words;
  size_t *start;       /* of each routine: where its table, or that of its leader, begins */
  const size_t *place; /* which of its targets it is */
  size_t largest_place, operation_count;
};

/* groups: of the routines, of which only leaders are encoded. */
struct RoutineTables encode_all(const struct Encoding *encoding, struct Routine *const *routines,
                                const struct ResultGroups *groups);

/* A check whose places are those of tables. */
struct LimitCheck encoded_check(const struct Encoding *encoding, const struct LimitCheck *check);
