#include "instructions.h"

#include <math.h>

#include "ldlt.h"

enum { INDEX_MASK = (1 << SLOT_BITS) - 1 };

struct Frame instructions_frame(const struct InstructionTables *tables, const struct Point *point) {
  struct Frame frame = {.tables = tables};
  frame.base[SPACE_NUMBER] = (Real *)tables->numbers;
  frame.base[SPACE_PARAMETER] = (Real *)point->parameter;
  frame.base[SPACE_PARAMETER_CONSTANTS] = (Real *)point->parameter_constants;
  frame.base[SPACE_STATE] = (Real *)point->state;
  frame.base[SPACE_INPUT] = (Real *)point->input;
  frame.base[SPACE_TIME] = (Real *)&point->time;
  if (point->work == NULL) return frame;
  frame.base[SPACE_LOCAL] = point->work;
  frame.base[SPACE_MASS] = frame.base[SPACE_LOCAL] + tables->local_count;
  frame.base[SPACE_RIGHT_SIDE] = frame.base[SPACE_MASS] + tables->mass_count;
  frame.base[SPACE_ACCELERATION] = frame.base[SPACE_RIGHT_SIDE] + tables->right_side_count;
  return frame;
}

void instructions_seed(struct Frame *frame, const struct Seed *seed) {
  frame->base[SPACE_SEED_PARAMETER] = (Real *)seed->parameter;
  frame->base[SPACE_SEED_STATE] = (Real *)seed->state;
  frame->base[SPACE_SEED_INPUT] = (Real *)seed->input;
  frame->base[SPACE_SEED_TIME] = (Real *)&seed->time;
  frame->base[SPACE_SEED_RESULT] = (Real *)seed->result;
}

static inline Real *at(Real *const *base, Slot slot) {
  return base[slot >> SLOT_BITS] + (slot & INDEX_MASK);
}

/* Factors a block of M. Returns 0, or 1 + the coordinate in which it is singular. */
static int factor(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  Real *mass = frame->base[SPACE_MASS] + block->first_mass;
  size_t singular = block->factor != NULL
                        ? block->factor(block->count, block->start, block->column, block->coordinate, mass)
                        : ldlt_factor(block->count, block->start, block->column, mass);
  return singular == 0 ? 0 : block->coordinate[singular - 1];
}

static void solve(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  Real *mass = frame->base[SPACE_MASS] + block->first_mass,
       *right_side = frame->base[SPACE_RIGHT_SIDE] + block->first_right_side;
  if (block->solve_nonsymmetric != NULL)
    block->solve_nonsymmetric(block->count, block->start, block->column, block->coordinate, mass, right_side);
  else if (block->solve != NULL) block->solve(block->count, block->start, block->column, mass, right_side);
  else ldlt_solve(block->count, block->start, block->column, mass, right_side);
}

static void take_least_forces(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  block->least_forces(block->count, block->start, block->column, block->coordinate,
                      frame->base[SPACE_MASS] + block->first_mass,
                      frame->base[SPACE_RIGHT_SIDE] + block->first_right_side);
}

enum { SPACE_MASK = (1 << SPACE_BITS) - 1 };

/*
 * Ends a case: executes all count instructions of a run, each of size words. R is the result, and A, B and C are the
 * operands, in their spaces. In series they are coefficients k; ROW_R and the like are whole rows.
 */
#define EACH(size, ...)                                                                                                \
  result = (uint32_t)code[0];                                                                                          \
  next_result = (uint32_t)code[1];                                                                                     \
  code += 2;                                                                                                           \
  if (is_spaced) {                                                                                                     \
    uint32_t index[] = {result, WORD(1, size, 0), WORD(2, size, 2), WORD(3, size, 4)};                                 \
    const uint32_t next[] = {next_result, WORD(1, size, 1), WORD(2, size, 3), WORD(3, size, 5)};                       \
    for (; count > 0; count--) {                                                                                       \
      __VA_ARGS__;                                                                                                     \
      for (int j = 0; j < (size); j++) index[j] += next[j];                                                            \
    }                                                                                                                  \
    code += 2 * (size)-2;                                                                                              \
  } else {                                                                                                             \
    uint32_t first = 0, second = 0, third = 0;                                                                         \
    for (; count > 0; count--, code += (size)-1, result += next_result) {                                              \
      const uint32_t index[] = {result, first += WORD(1, size, 0), second += WORD(2, size, 1),                         \
                                third += WORD(3, size, 2)};                                                            \
      __VA_ARGS__;                                                                                                     \
    }                                                                                                                  \
  }                                                                                                                    \
  break
#define WORD(operand, size, number) ((operand) < (size) ? (uint32_t)code[number] : 0)
#define R r[index[0]]
#define A a[index[1]]
#define B b[index[2]]
#define C c[index[3]]
#define ROW_R (row_r + index[0])
#define ROW_A (row_a + index[1])
#define ROW_B (row_b + index[2])
#define ROW_C (row_c + index[3])

/* Returns the space of an operand, 0 for the result, in all instructions of a run. */
static inline uint32_t space_of_operand(uint32_t spaces, int number) {
  return spaces >> number * SPACE_BITS & SPACE_MASK;
}

/* Sets count numbers to the same value. */
static void fill_equal(Real *numbers, Real value, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) numbers[i] = value;
}

int instructions_run(const struct Frame *frame, const int32_t *code) {
  Real *const *base = frame->base;
  for (;;) {
    enum Opcode opcode = (enum Opcode)code[0];
    if (opcode == END) return 0;
    const bool is_spaced = (code[1] & SPACED) != 0;
    uint32_t count = (uint32_t)(code[1] & ~SPACED), spaces = (uint32_t)code[2], result, next_result;
    Real *r = base[space_of_operand(spaces, 0)];
    const Real *a = base[space_of_operand(spaces, 1)], *b = base[space_of_operand(spaces, 2)];
    code += 3;
    switch (opcode) {
    case COPY:
      if (is_spaced && code[1] == 1 && code[3] == 0) { /* elements of K that are 0 before the factorization */
        fill_equal(r + code[0], a[code[2]], count);
        code += 4;
        break;
      }
      EACH(2, R = A);
    case FIRST_SLOPE: EACH(2, R = (&A)[1]);
    case SUM: EACH(3, R = A + B);
    case DIFFERENCE: EACH(3, R = A - B);
    case PRODUCT: EACH(3, R = A * B);
    case QUOTIENT: EACH(3, R = A / B);
    case NEGATION: EACH(2, R = -A);
    case SQUARE: EACH(2, R = A * A);
    case CUBE: EACH(2, R = A * A * A);
    case FOURTH: EACH(2, R = A * A * A * A);
    case RECIPROCAL: EACH(2, R = 1.0 / A);
    case INVERSE_SQUARE: EACH(2, R = 1.0 / (A * A));
    case INVERSE_CUBE: EACH(2, R = 1.0 / (A * A * A));
    case INVERSE_FOURTH: EACH(2, R = 1.0 / (A * A * A * A));
    case SQUARE_ROOT: EACH(2, R = sqrt(A));
    case INVERSE_ROOT: EACH(2, R = 1.0 / sqrt(A));
    case LESS_THAN: EACH(3, R = WHERE(A < B, 1.0, 0.0));
    case GUARD_OF: EACH(3, R = WHERE(A > 0.0, B, 0.0));
    case SIGN_OF: EACH(2, R = WHERE(A > 0.0, 1.0, WHERE(A < 0.0, -1.0, 0.0)));
    case CALL: {
      Real (*function)(Real) = frame->tables->functions[*code++];
      EACH(2, R = function(A));
    }
    case CALL_OF_TWO: {
      Real (*function)(Real, Real) = frame->tables->functions_of_two[*code++];
      EACH(3, R = function(A, B));
    }
    case CHECK_POSITIVE: EACH(2, REQUIRE(A > 0.0, (int)index[0]));
    case CHECK_PIVOT: EACH(3, REQUIRE(A > 1e-14 * B, (int)index[0]));
    case CHECK_DIAGONAL: EACH(3, REQUIRE(A > 1e-28 * B, (int)index[0]));
    case FACTOR: EACH(1, int singular = factor(frame, index[0]); if (singular != 0) return singular);
    case SOLVE: EACH(1, solve(frame, index[0]));
    case LEAST_FORCES: EACH(1, take_least_forces(frame, index[0]));
    case SKIP: code += ANYWHERE(a[code[0]] > 0.0) ? 1 : 1 + count; break;
    default: return -1; /* lagc writes no other opcode */
    }
  }
}

void instructions_run_order(const struct Frame *frame, const int32_t *code, int k) {
  Real *const *base = frame->base;
  for (;;) {
    enum Opcode opcode = (enum Opcode)code[0];
    if (opcode == END) return;
    const bool is_spaced = (code[1] & SPACED) != 0;
    uint32_t count = (uint32_t)(code[1] & ~SPACED), spaces = (uint32_t)code[2], result, next_result;
    const uint32_t space_r = space_of_operand(spaces, 0), space_a = space_of_operand(spaces, 1);
    const uint32_t space_b = space_of_operand(spaces, 2), space_c = space_of_operand(spaces, 3);
    Real *const row_r = base[space_r], *const r = row_r + (space_r >= SPACE_ROW ? k : 0);
    const Real *const row_a = base[space_a], *const a = row_a + (space_a >= SPACE_ROW ? k : 0);
    const Real *const row_b = base[space_b], *const b = row_b + (space_b >= SPACE_ROW ? k : 0);
    const Real *const row_c = base[space_c], *const c = row_c + (space_c >= SPACE_ROW ? k : 0);
    code += 3;
    switch (opcode) {
    case SERIES_COPY: EACH(2, R = A);
    case SERIES_ZERO: EACH(1, R = REAL(0.0));
    case SERIES_SUM: EACH(3, R = A + B);
    case SERIES_DIFFERENCE: EACH(3, R = A - B);
    case SERIES_NEGATION: EACH(2, R = -A);
    case SERIES_GUARD: EACH(3, R = WHERE(*ROW_A > 0.0, B, 0.0));
    case SERIES_MULTIPLE: EACH(3, R = *ROW_A * B);
    case SERIES_SHARE: EACH(3, R = A / *ROW_B);
    case SERIES_PRODUCT: EACH(3, R = series_product(k, ROW_A, ROW_B));
    case SERIES_SQUARE: EACH(2, R = series_square(k, ROW_A));
    case SERIES_QUOTIENT: EACH(4, R = series_quotient(k, A, *ROW_C, ROW_B, ROW_R));
    case SERIES_ROOT: EACH(2, R = series_root(k, ROW_A, ROW_R));
    case SERIES_POWER: EACH(3, R = series_power(k, *ROW_B, ROW_A, ROW_R));
    case SERIES_RATE: EACH(2, (&R)[-1] = k * A);
    case SERIES_INTEGRAL: EACH(3, R = series_integral(k, ROW_A, ROW_B));
    case SERIES_NEGATIVE_INTEGRAL: EACH(3, R = -series_integral(k, ROW_A, ROW_B));
    case SERIES_TURN: EACH(3, R = *ROW_A * (&B)[-1] * reciprocal[k]);
    case SERIES_NEGATIVE_TURN: EACH(3, R = -(*ROW_A * (&B)[-1]) * reciprocal[k]);
    case SERIES_RATIO_INTEGRAL: EACH(3, R = series_ratio_integral(k, A, ROW_B, ROW_R));
    case SERIES_AREA: EACH(3, R = series_area(k, ROW_A, ROW_B));
    case SERIES_ANGLE: EACH(4, R = series_angle(k, ROW_A, ROW_B, ROW_C, ROW_R));
    case SERIES_ABSOLUTE: EACH(2, R = series_absolute(k, ROW_A));
    case SERIES_LARGER: EACH(4, R = WHERE(series_sign(k, ROW_A) > 0.0, B, C));
    case SERIES_SMALLER: EACH(4, R = WHERE(series_sign(k, ROW_A) < 0.0, B, C));
    case SERIES_REST: EACH(4, R = A - series_rest(k, ROW_B, ROW_C));
    case SERIES_SOLVE: EACH(1, solve(frame, index[0]));
    case SERIES_STATE: EACH(2, (&R)[1] = A * reciprocal[k + 1]);
    case SERIES_SLOPE: EACH(2, R = (k + 1) * (&A)[1]);
    case SKIP: code += ANYWHERE(row_a[code[0]] > 0.0) ? 1 : 1 + count; break;
    default: return; /* lagc writes no other opcode */
    }
  }
}

#undef R
#undef A
#undef B
#undef C

static void check_limit(const struct Frame *frame, const struct LimitCheck *check, struct SeriesLimit *limit) {
  const Real *u = at(frame->base, check->row);
  switch (check->rule) {
  case LIMIT_EXPONENTIAL: series_limit_exponential(limit, u, check->function); break;
  case LIMIT_HYPERBOLIC: series_limit_hyperbolic(limit, u, check->function); break;
  case LIMIT_BOUNDED: series_limit_bounded(limit, u, check->function); break;
  case LIMIT_TANH: series_limit_tanh(limit, u); break;
  case LIMIT_TANGENT: series_limit_tangent(limit, u); break;
  case LIMIT_POSITIVE: series_limit_positive(limit, u, check->function); break;
  case LIMIT_QUOTIENT: series_limit_quotient(limit, u, check->share); break;
  case LIMIT_ROOT: series_limit_root(limit, u, check->share); break;
  case LIMIT_WHOLE_POWER: series_limit_whole_power(limit, u, check->share); break;
  case LIMIT_DIVISION: series_limit_division(limit, u, at(frame->base, check->other_row), check->share); break;
  case LIMIT_POWER: series_limit_power(limit, u, *at(frame->base, check->exponent)); break;
  case LIMIT_SIGN: series_limit_sign(limit, u, check->function); break;
  case LIMIT_ANGLE: series_limit_angle(limit, u, at(frame->base, check->other_row)); break;
  case LIMIT_RULE_COUNT: break;
  }
}

void instructions_limit(const struct Frame *frame, const struct LimitCheck *checks, size_t count,
                        struct SeriesLimit *limit) {
  for (size_t i = 0; i < count; i++) {
    const struct LimitCheck *check = &checks[i];
    if (check->is_guarded)
      LIMIT_WHERE(*at(frame->base, check->guard_condition) > 0.0, check_limit(frame, check, limit));
    else check_limit(frame, check, limit);
  }
}
