#include "program/routine.h"

#include <stdlib.h>

#include "memory.h"

/* Checks and blocks have statements of their own, which the writers know. */
static const struct OpcodeFacts facts[OPCODE_COUNT] = {
    [END] = {.name = "END"},
    [COPY] = {"COPY", "$1", VALUE, {VALUE}, 0, false},
    [FIRST_SLOPE] = {"FIRST_SLOPE", "$1[1]", VALUE, {ROW}, 0, false},
    [SUM] = {"SUM", "$1 + $2", VALUE, {VALUE, VALUE}, 1, false},
    [DIFFERENCE] = {"DIFFERENCE", "$1 - $2", VALUE, {VALUE, VALUE}, 1, false},
    [PRODUCT] = {"PRODUCT", "$1 * $2", VALUE, {VALUE, VALUE}, 1, false},
    [QUOTIENT] = {"QUOTIENT", "$1 / $2", VALUE, {VALUE, VALUE}, 1, false},
    [NEGATION] = {"NEGATION", "-$1", VALUE, {VALUE}, 1, false},
    [SQUARE] = {"SQUARE", "$1 * $1", VALUE, {VALUE}, 1, false},
    [CUBE] = {"CUBE", "$1 * $1 * $1", VALUE, {VALUE}, 2, false},
    [FOURTH] = {"FOURTH", "$1 * $1 * $1 * $1", VALUE, {VALUE}, 3, false},
    [RECIPROCAL] = {"RECIPROCAL", "1.0 / $1", VALUE, {VALUE}, 1, false},
    [INVERSE_SQUARE] = {"INVERSE_SQUARE", "1.0 / ($1 * $1)", VALUE, {VALUE}, 2, false},
    [INVERSE_CUBE] = {"INVERSE_CUBE", "1.0 / ($1 * $1 * $1)", VALUE, {VALUE}, 3, false},
    [INVERSE_FOURTH] = {"INVERSE_FOURTH", "1.0 / ($1 * $1 * $1 * $1)", VALUE, {VALUE}, 4, false},
    [SQUARE_ROOT] = {"SQUARE_ROOT", "sqrt($1)", VALUE, {VALUE}, 1, false},
    [INVERSE_ROOT] = {"INVERSE_ROOT", "1.0 / sqrt($1)", VALUE, {VALUE}, 2, false},
    [LESS_THAN] = {"LESS_THAN", "$1 < $2 ? 1.0 : 0.0", VALUE, {VALUE, VALUE}, 1, false},
    [SIGN_OF] = {"SIGN_OF", "$1 > 0.0 ? 1.0 : $1 < 0.0 ? -1.0 : 0.0", VALUE, {VALUE}, 1, false},
    [CALL] = {"CALL", "$f($1)", VALUE, {VALUE}, 1, false},
    [CALL_OF_TWO] = {"CALL_OF_TWO", "$f($1, $2)", VALUE, {VALUE, VALUE}, 1, false},
    [CHECK_POSITIVE] = {"CHECK_POSITIVE", "if (!($1 > 0.0)) return $0", NUMBER, {VALUE}, 0, false},
    [CHECK_PIVOT] = {"CHECK_PIVOT", "if (!($1 > 1e-14 * $2)) return $0", NUMBER, {VALUE, VALUE}, 0, false},
    [CHECK_DIAGONAL] = {"CHECK_DIAGONAL", "if (!($1 > 1e-28 * $2)) return $0", NUMBER, {VALUE, VALUE}, 0, false},
    [FACTOR] = {"FACTOR", NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SOLVE] = {"SOLVE", NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SERIES_COPY] = {"SERIES_COPY", "$1", COEFFICIENT, {COEFFICIENT}, 0, false},
    [SERIES_ZERO] = {"SERIES_ZERO", "0.0", COEFFICIENT, {NO_OPERAND}, 0, false},
    [SERIES_SUM] = {"SERIES_SUM", "$1 + $2", COEFFICIENT, {COEFFICIENT, COEFFICIENT}, 1, false},
    [SERIES_DIFFERENCE] = {"SERIES_DIFFERENCE", "$1 - $2", COEFFICIENT, {COEFFICIENT, COEFFICIENT}, 1, false},
    [SERIES_NEGATION] = {"SERIES_NEGATION", "-$1", COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_MULTIPLE] = {"SERIES_MULTIPLE", "$1 * $2", COEFFICIENT, {VALUE, COEFFICIENT}, 1, false},
    [SERIES_SHARE] = {"SERIES_SHARE", "$1 / $2", COEFFICIENT, {COEFFICIENT, VALUE}, 1, false},
    [SERIES_PRODUCT] = {"SERIES_PRODUCT", "series_product(k, $1, $2)", COEFFICIENT, {ROW, ROW}, 1, true},
    [SERIES_SQUARE] = {"SERIES_SQUARE", "series_square(k, $1)", COEFFICIENT, {ROW}, 1, true},
    [SERIES_QUOTIENT] =
        {"SERIES_QUOTIENT", "series_quotient(k, $1, $3, $2, $0)", ROW, {COEFFICIENT, ROW, VALUE}, 1, true},
    [SERIES_ROOT] = {"SERIES_ROOT", "series_root(k, $1, $0)", ROW, {ROW}, 1, true},
    [SERIES_POWER] = {"SERIES_POWER", "series_power(k, $2, $1, $0)", ROW, {ROW, VALUE}, 1, true},
    [SERIES_RATE] = {"SERIES_RATE", "k * $1", PAST_COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_INTEGRAL] = {"SERIES_INTEGRAL", "series_integral(k, $1, $2)", COEFFICIENT, {ROW, ROW_OF_PAST}, 1, true},
    [SERIES_NEGATIVE_INTEGRAL] =
        {"SERIES_NEGATIVE_INTEGRAL", "-series_integral(k, $1, $2)", COEFFICIENT, {ROW, ROW_OF_PAST}, 1, true},
    [SERIES_TURN] = {"SERIES_TURN", "$1 * $2[k - 1] * (1.0 / k)", COEFFICIENT, {VALUE, ROW_OF_PAST}, 2, true},
    [SERIES_NEGATIVE_TURN] =
        {"SERIES_NEGATIVE_TURN", "-($1 * $2[k - 1]) * (1.0 / k)", COEFFICIENT, {VALUE, ROW_OF_PAST}, 2, true},
    [SERIES_RATIO_INTEGRAL] =
        {"SERIES_RATIO_INTEGRAL", "series_ratio_integral(k, $1, $2, $0)", ROW, {COEFFICIENT, ROW_OF_PAST}, 1, true},
    [SERIES_AREA] = {"SERIES_AREA", "series_area(k, $1, $2)", COEFFICIENT, {ROW, ROW}, 1, true},
    [SERIES_ANGLE] = {"SERIES_ANGLE", "series_angle(k, $1, $2, $3, $0)", ROW, {ROW, ROW, ROW_OF_PAST}, 1, true},
    [SERIES_ABSOLUTE] = {"SERIES_ABSOLUTE", "series_absolute(k, $1)", COEFFICIENT, {ROW}, 1, true},
    [SERIES_LARGER] =
        {"SERIES_LARGER", "series_sign(k, $1) > 0.0 ? $2 : $3", COEFFICIENT, {ROW, COEFFICIENT, COEFFICIENT}, 1, true},
    [SERIES_SMALLER] =
        {"SERIES_SMALLER", "series_sign(k, $1) < 0.0 ? $2 : $3", COEFFICIENT, {ROW, COEFFICIENT, COEFFICIENT}, 1, true},
    [SERIES_REST] =
        {"SERIES_REST", "$1 - series_rest(k, $2, $3)", COEFFICIENT, {COEFFICIENT, ROW, ROW_OF_PAST}, 2, true},
    [SERIES_SOLVE] = {"SERIES_SOLVE", NULL, BLOCK, {NO_OPERAND}, 0, false},
    [SERIES_STATE] = {"SERIES_STATE", "$1 * (1.0 / (k + 1))", NEXT_COEFFICIENT, {COEFFICIENT}, 1, false},
    [SERIES_SLOPE] = {"SERIES_SLOPE", "(k + 1) * $1", COEFFICIENT, {NEXT_COEFFICIENT}, 1, false},
};

const struct OpcodeFacts *opcode_facts(enum Opcode opcode) {
  return &facts[opcode];
}

int opcode_arity(enum Opcode opcode) {
  int arity = 0;
  while (arity < OPERAND_LIMIT && facts[opcode].operands[arity] != NO_OPERAND) arity++;
  return arity;
}

struct Routine *routine_create(void) {
  return allocate(1, sizeof(struct Routine));
}

void routine_free(struct Routine *routine) {
  if (routine == NULL) return;
  free(routine->instructions);
  free(routine);
}

static void append(struct Routine *routine, struct Instruction instruction) {
  const struct OpcodeFacts *fact = &facts[instruction.opcode];
  if (routine->count == routine->capacity) {
    routine->capacity = 2 * routine->capacity + 16;
    routine->instructions = reallocate(routine->instructions, routine->capacity, sizeof *routine->instructions);
  }
  routine->instructions[routine->count++] = instruction;
  routine->operation_count += fact->operations;
  if (fact->result != NUMBER && fact->result != BLOCK) routine->spaces |= 1u << space_of(instruction.result);
  for (int i = 0; i < opcode_arity(instruction.opcode); i++) routine->spaces |= 1u << space_of(instruction.operands[i]);
}

void routine_append(struct Routine *routine, enum Opcode opcode, Place result, Place a, Place b, Place c) {
  append(routine, (struct Instruction){.opcode = opcode, .result = result, .operands = {a, b, c}});
}

void routine_append_call(struct Routine *routine, enum Operation function, Place result, Place a, Place b) {
  enum Opcode opcode = operation_arity(function) == 2 ? CALL_OF_TWO : CALL;
  append(routine, (struct Instruction){.opcode = opcode, .function = function, .result = result, .operands = {a, b}});
}

Place routine_local(struct Routine *routine) {
  return place_in(SPACE_LOCAL, routine->local_count++);
}

bool routine_uses(const struct Routine *routine, enum Space space) {
  return (routine->spaces >> space & 1u) != 0;
}
