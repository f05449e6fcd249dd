/*
 * The intermediate representation: an IrFunction holds the instructions of one generated function, each result
 * before its uses. include/instructions.h has the instruction set.
 */
#pragma once

#include <stdbool.h>

#include "algebra/graph.h"
#include "instructions.h"

/* Operands of an instruction. */
enum { OPERAND_LIMIT = 3 };

/* An instruction; unused operands are 0. */
struct Instruction {
  enum Opcode opcode;
  enum Operation function; /* of CALL and CALL_OF_TWO */
  Slot result;             /* of checks: the number to return; of FACTOR, SOLVE and LEAST_FORCES: the block */
  Slot operands[OPERAND_LIMIT];
};

/* The instructions of a function. */
struct IrFunction {
  struct Instruction *instructions;
  size_t count;
  size_t local_count;
  size_t operation_count; /* arithmetic operations, see costs.h */
  uint32_t spaces;        /* bit s: some operand or result is in space s */
  Slot *row_conditions;   /* of functions of a series, of each row: see regions.h; else NULL */
};

/* Returns the slot with this index in a space. */
static inline Slot slot_at(enum Space space, size_t index) {
  return (Slot)space << SLOT_BITS | (Slot)index;
}

/* Returns the slot of an element of the array that the function fills. */
static inline Slot target_slot(size_t index) {
  return slot_at(SPACE_TARGET, index);
}

/* Returns the space of a slot. */
static inline enum Space space_of(Slot slot) {
  return (enum Space)(slot >> SLOT_BITS);
}

/* Returns the index of a slot in its space. */
static inline size_t index_in(Slot slot) {
  return slot & ((1u << SLOT_BITS) - 1);
}

/* How an instruction uses an operand or result, at the order k of a series. */
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

/* Properties of an opcode for the writers and the schedule. */
struct OpcodeMetadata {
  /* C expression: $0 is the result; $1, $2, $3 are the operands, $f is the function; $( opens the arguments */
  const char *statement;
  enum Role result, operands[OPERAND_LIMIT];
  size_t operations;
  bool is_recurrence;
};

/* Returns the row of the opcode in the table, which is static. */
const struct OpcodeMetadata *opcode_metadata(enum Opcode opcode);

/* Returns the arguments of the opcode's Cauchy product for SERIES_MIDDLES of include/series.h; NULL if it has none. */
const char *opcode_factors(enum Opcode opcode);

/* True if the opcode stores a result in a slot. */
bool opcode_has_result(enum Opcode opcode);

/* Returns the number of operands. */
int opcode_arity(enum Opcode opcode);

/* Returns a function without instructions. */
struct IrFunction *ir_create(void);

/* Appends an instruction; operands beyond the opcode's arity are ignored. */
void ir_append(struct IrFunction *ir, enum Opcode opcode, Slot result, Slot a, Slot b, Slot c);

/* Appends an instruction that copies one slot to another. */
void ir_copy(struct IrFunction *ir, Slot to, Slot from);

/* Appends a call of a function of one or two operands. */
void ir_append_call(struct IrFunction *ir, enum Operation function, Slot result, Slot a, Slot b);

/* Returns a new local variable. */
Slot ir_new_local(struct IrFunction *ir);

/* True if any operand or result is in the space. */
bool ir_uses(const struct IrFunction *ir, enum Space space);
