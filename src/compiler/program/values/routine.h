/*
 * A routine: the instructions of one function of the generated code, in an order in which each result stands before
 * its uses. The instructions themselves are those of include/instructions.h.
 */
#pragma once

#include <stdbool.h>

#include "algebra/graph.h"
#include "instructions.h"

enum { OPERAND_LIMIT = 3 };

struct Instruction {
  enum Opcode opcode;
  enum Operation function; /* of CALL and CALL_OF_TWO */
  Place result;            /* in checks the number to return, in FACTOR, SOLVE and LEAST_FORCES the block */
  Place operands[OPERAND_LIMIT];
};

struct Routine {
  struct Instruction *instructions;
  size_t count;
  size_t local_count;
  size_t operation_count; /* additions, multiplications, functions, ... */
  uint32_t spaces;        /* bit s: some operand or result is in enum Space s */
};

static inline Place place_in(enum Space space, size_t index) {
  return (Place)space << PLACE_BITS | (Place)index;
}

/* An element of what the function fills. */
static inline Place target_place(size_t index) {
  return place_in(SPACE_TARGET, index);
}

static inline enum Space space_of(Place place) {
  return (enum Space)(place >> PLACE_BITS);
}

static inline size_t index_in(Place place) {
  return place & ((1u << PLACE_BITS) - 1);
}

/* How an operand is used; the result likewise. */
enum Role {
  NO_OPERAND,
  VALUE,
  COEFFICIENT,      /* the coefficient k */
  ROW,              /* all coefficients up to k */
  ROW_OF_PAST,      /* all coefficients below k */
  NEXT_COEFFICIENT, /* the coefficient k + 1 */
  PAST_COEFFICIENT, /* the coefficient k - 1 */
  BLOCK,
  NUMBER
};

/* What the writers need to know of an opcode. */
struct OpcodeFacts {
  const char *statement; /* of C: $0 is the result, $1, $2, $3 the operands, $f the function, $( opens the arguments */
  enum Role result, operands[OPERAND_LIMIT];
  size_t operations;
  bool is_recurrence;
};

const struct OpcodeFacts *opcode_facts(enum Opcode opcode);

/* Of its product of two rows, as SERIES_MIDDLES of include/series.h takes them; NULL for none. */
const char *opcode_factors(enum Opcode opcode);

/* Whether the opcode has a place for its result. */
bool opcode_has_result(enum Opcode opcode);

/* How many operands the opcode has. */
int opcode_arity(enum Opcode opcode);

struct Routine *routine_create(void);

/* Appends an instruction; operands that the opcode does not have are ignored. */
void routine_append(struct Routine *routine, enum Opcode opcode, Place result, Place a, Place b, Place c);

/* Appends a copy of what is in a place to another. */
void routine_copy(struct Routine *routine, Place to, Place from);

/* Appends a call of a function. */
void routine_append_call(struct Routine *routine, enum Operation function, Place result, Place a, Place b);

/* A new local variable. */
Place routine_local(struct Routine *routine);

/* Whether any operand or result is in the space. */
bool routine_uses(const struct Routine *routine, enum Space space);
