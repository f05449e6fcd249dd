/* Encodes functions as instruction tables; include/instructions.h describes the format. */
#pragma once

#include "program/program.h"

/* The constants and functions that the tables of a program refer to. */
struct Encoding {
  const struct Program *program;
  size_t *number; /* for each node: 1 + the index of a constant in numbers, 0 for none */
  struct NodeList numbers;
  size_t function[OPERATION_COUNT]; /* 1 + the function's index among those of the same arity, 0 for none */
  size_t local_count;               /* the largest number of local variables of a function in tables */
};

/* Collects the constants and functions that the tables of a program use. */
struct Encoding *encoding_create(const struct Program *program);

/* Returns the length of Point.work that the tables need. */
size_t encoding_work_count(const struct Encoding *encoding);

/* The words of consecutive tables. */
struct WordList {
  int32_t *items;
  size_t count;
};

/* Appends the table of a function, terminated by END. */
void encode(const struct Encoding *encoding, const struct IrFunction *ir, struct WordList *words);

/*
 * Parts of two functions that begin with the same instructions. Those before the first that reads the seed come first,
 * then the others that are equal, then both ends.
 */
enum { PAIR_STEADY, PAIR_COMMON, PAIR_END, PAIR_SECOND_END, PAIR_PARTS };

/* Fills the tables of the parts, each terminated by END; those without instructions stay empty. second may be NULL. */
void encode_pair(const struct Encoding *encoding, const struct IrFunction *first, const struct IrFunction *second,
                 struct WordList words[PAIR_PARTS]);

/* Consecutive tables of several functions. */
struct IrTables {
  struct WordList words;
  size_t *start;      /* of each function: the offset of its table, or of its leader's */
  const size_t *slot; /* of each function: its index among the targets of the leader's table */
  size_t largest_slot, operation_count;
};

/* Encodes the functions that lead a group; functions may be NULL. */
struct IrTables encode_all(const struct Encoding *encoding, struct IrFunction *const *ir_functions,
                           const struct ResultGroups *groups);

/* Returns the check with the slots that tables use. */
struct LimitCheck encoded_check(const struct Encoding *encoding, const struct LimitCheck *check);
