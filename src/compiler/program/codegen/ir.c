#include "program/codegen/ir.h"

#include "base/memory.h"

/* FACTOR, SOLVE and the like have no expression; the writers know their statements. */
static const struct OpcodeMetadata metadata[OPCODE_COUNT] = {
    [COPY] = {"$1", VALUE, {VALUE}, 0, false},
    [FIRST_SLOPE] = {"$1[1]", VALUE, {ROW}, 0, false},
    [SUM] = {"$1 + $2", VALUE, {VALUE, VALUE}, 1, false},
    [DIFFERENCE] = {"$1 - $2", VALUE, {VALUE, VALUE}, 1, false},
    [PRODUCT] = {"$1 * $2", VALUE, {VALUE, VALUE}, 1, false},
    [QUOTIENT] = {"$1 / $2", VALUE, {VALUE, VALUE}, 1, false},
    [NEGATION] = {"-$1", VALUE, {VALUE}, 1, false},
    [SQUARE] = {"$1 * $1", VALUE, {VALUE}, 1, false},
    [CUBE] = {"$1 * $1 * $1", VALUE, {VALUE}, 2, false},
    [FOURTH] = {"$1 * $1 * $1 * $1", VALUE, {VALUE}, 3, false},
    [RECIPROCAL] = {"1.0 / $1", VALUE, {VALUE}, 1, false},
    [INVERSE_SQUARE] = {"1.0 / ($1 * $1)", VALUE, {VALUE}, 2, false},
    [INVERSE_CUBE] = {"1.0 / ($1 * $1 * $1)", VALUE, {VALUE}, 3, false},
    [INVERSE_FOURTH] = {"1.0 / ($1 * $1 * $1 * $1)", VALUE, {VALUE}, 4, false},
    [SQUARE_ROOT] = {"sqrt($1)", VALUE, {VALUE}, 1, false},
    [INVERSE_ROOT] = {"1.0 / sqrt($1)", VALUE, {VALUE}, 2, false},
    [LESS_THAN] = {"WHERE($1 < $2, 1.0, 0.0)", VALUE, {VALUE, VALUE}, 1, false},
    [SIGN_OF] = {"WHERE($1 > 0.0, 1.0, WHERE($1 < 0.0, -1.0, 0.0))", VALUE, {VALUE}, 1, false},
    [GUARD_OF] = {"WHERE($1 > 0.0, $2, 0.0)", VALUE, {VALUE, VALUE}, 1, false},
    [CALL] = {"$f($1)", VALUE, {VALUE}, 1, false},
    [CALL_OF_TWO] = {"$f($1, $2)", VALUE, {VALUE, VALUE}, 1, false},
    [CHECK_POSITIVE] = {"REQUIRE($1 > 0.0, $0)", NUMBER, {VALUE}, 0, false},
    [CHECK_PIVOT] = {"REQUIRE($1 > 1e-14 * $2, $0)", NUMBER, {VALUE, VALUE}, 0, false},
    [CHECK_DIAGONAL] = {"REQUIRE($1 > 1e-28 * $2, $0)", NUMBER, {VALUE, VALUE}, 0, false},
    [FACTOR] = {NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SOLVE] = {NULL, BLOCK, {NO_OPERAND}, 0, false},
    [LEAST_FORCES] = {NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SKIP] = {NULL, BLOCK, {VALUE}, 0, false},
    [SERIES_COPY] = {"$1", COEFFICIENT, {COEFFICIENT}, 0, false},
    [SERIES_ZERO] = {"REAL(0.0)", COEFFICIENT, {NO_OPERAND}, 0, false},
    [SERIES_SUM] = {"$1 + $2", COEFFICIENT, {COEFFICIENT, COEFFICIENT}, 1, false},
    [SERIES_DIFFERENCE] = {"$1 - $2", COEFFICIENT, {COEFFICIENT, COEFFICIENT}, 1, false},
    [SERIES_NEGATION] = {"-$1", COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_MULTIPLE] = {"$1 * $2", COEFFICIENT, {VALUE, COEFFICIENT}, 1, false},
    [SERIES_SHARE] = {"$1 / $2", COEFFICIENT, {COEFFICIENT, VALUE}, 1, false},
    [SERIES_PRODUCT] = {"series_product$(k, $1, $2)", COEFFICIENT, {ROW, ROW}, 1, true},
    [SERIES_SQUARE] = {"series_square$(k, $1)", COEFFICIENT, {ROW}, 1, true},
    [SERIES_QUOTIENT] = {"series_quotient$(k, $1, $3, $2, $0)", ROW, {COEFFICIENT, ROW, VALUE}, 1, true},
    [SERIES_ROOT] = {"series_root$(k, $1, $0)", ROW, {ROW}, 1, true},
    [SERIES_POWER] = {"series_power(k, $2, $1, $0)", ROW, {ROW, VALUE}, 1, true},
    [SERIES_RATE] = {"k * $1", PAST_COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_INTEGRAL] = {"series_integral$(k, $1, $2)", COEFFICIENT, {ROW, ROW_OF_PAST}, 1, true},
    [SERIES_NEGATIVE_INTEGRAL] = {"-series_integral$(k, $1, $2)", COEFFICIENT, {ROW, ROW_OF_PAST}, 1, true},
    [SERIES_TURN] = {"$1 * $2[k - 1] * reciprocal[k]", COEFFICIENT, {VALUE, ROW_OF_PAST}, 2, true},
    [SERIES_NEGATIVE_TURN] = {"-($1 * $2[k - 1]) * reciprocal[k]", COEFFICIENT, {VALUE, ROW_OF_PAST}, 2, true},
    [SERIES_RATIO_INTEGRAL] = {"series_ratio_integral(k, $1, $2, $0)", ROW, {COEFFICIENT, ROW_OF_PAST}, 1, true},
    [SERIES_AREA] = {"series_area(k, $1, $2)", COEFFICIENT, {ROW, ROW}, 1, true},
    [SERIES_ANGLE] = {"series_angle(k, $1, $2, $3, $0)", ROW, {ROW, ROW, ROW_OF_PAST}, 1, true},
    [SERIES_ABSOLUTE] = {"series_absolute(k, $1)", COEFFICIENT, {ROW}, 1, true},
    [SERIES_LARGER] =
        {"WHERE(series_sign(k, $1) > 0.0, $2, $3)", COEFFICIENT, {ROW, COEFFICIENT, COEFFICIENT}, 1, true},
    [SERIES_SMALLER] =
        {"WHERE(series_sign(k, $1) < 0.0, $2, $3)", COEFFICIENT, {ROW, COEFFICIENT, COEFFICIENT}, 1, true},
    [SERIES_GUARD] = {"WHERE($1 > 0.0, $2, 0.0)", COEFFICIENT, {VALUE, COEFFICIENT}, 1, false},
    [SERIES_REST] = {"$1 - series_rest$(k, $2, $3)", COEFFICIENT, {COEFFICIENT, ROW, ROW_OF_PAST}, 2, true},
    [SERIES_SOLVE] = {NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SERIES_STATE] = {"$1 * reciprocal[k + 1]", NEXT_COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_SLOPE] = {"(k + 1) * $1", COEFFICIENT, {NEXT_COEFFICIENT}, 1, false},
};

static const char *const factors[OPCODE_COUNT] = {
    [SERIES_PRODUCT] = "$1, 1, $2", [SERIES_SQUARE] = "$1, 1, $1",   [SERIES_QUOTIENT] = "$2, 1, $0",
    [SERIES_ROOT] = "$0, 1, $0",    [SERIES_INTEGRAL] = "$1, 0, $2", [SERIES_NEGATIVE_INTEGRAL] = "$1, 0, $2",
    [SERIES_REST] = "$2, 1, $3",
};

const struct OpcodeMetadata *opcode_metadata(enum Opcode opcode) {
  return &metadata[opcode];
}

const char *opcode_factors(enum Opcode opcode) {
  return factors[opcode];
}

bool opcode_has_result(enum Opcode opcode) {
  return metadata[opcode].result != NUMBER && metadata[opcode].result != BLOCK;
}

int opcode_arity(enum Opcode opcode) {
  int arity = 0;
  while (arity < OPERAND_LIMIT && metadata[opcode].operands[arity] != NO_OPERAND) arity++;
  return arity;
}

struct IrFunction *ir_create(void) {
  return allocate(1, sizeof(struct IrFunction));
}

static void append(struct IrFunction *ir, struct Instruction instruction) {
  APPEND(ir->instructions, ir->count, instruction);
  ir->operation_count += metadata[instruction.opcode].operations;
  if (opcode_has_result(instruction.opcode)) ir->spaces |= 1u << space_of(instruction.result);
  for (int i = 0; i < opcode_arity(instruction.opcode); i++) ir->spaces |= 1u << space_of(instruction.operands[i]);
}

void ir_append(struct IrFunction *ir, enum Opcode opcode, Slot result, Slot a, Slot b, Slot c) {
  append(ir, (struct Instruction){.opcode = opcode, .result = result, .operands = {a, b, c}});
}

void ir_copy(struct IrFunction *ir, Slot to, Slot from) {
  ir_append(ir, COPY, to, from, 0, 0);
}

void ir_append_call(struct IrFunction *ir, enum Operation function, Slot result, Slot a, Slot b) {
  enum Opcode opcode = operation_arity(function) == 2 ? CALL_OF_TWO : CALL;
  append(ir, (struct Instruction){.opcode = opcode, .function = function, .result = result, .operands = {a, b}});
}

Slot ir_new_local(struct IrFunction *ir) {
  return slot_at(SPACE_LOCAL, ir->local_count++);
}

bool ir_uses(const struct IrFunction *ir, enum Space space) {
  return (ir->spaces >> space & 1u) != 0;
}
