#include "instructions.h"

#include <math.h>

#include "ldlt.h"

enum { INDEX_MASK = (1 << PLACE_BITS) - 1 };

struct Frame instructions_frame(const struct InstructionTables *tables, const struct Point *point) {
  struct Frame frame = {.tables = tables};
  frame.base[SPACE_NUMBER] = (double *)tables->numbers;
  frame.base[SPACE_PARAMETER] = (double *)point->parameter;
  frame.base[SPACE_PREPARED] = (double *)point->prepared;
  frame.base[SPACE_STATE] = (double *)point->state;
  frame.base[SPACE_INPUT] = (double *)point->input;
  frame.base[SPACE_TIME] = (double *)&point->time;
  if (point->work == NULL) return frame;
  frame.base[SPACE_LOCAL] = point->work;
  frame.base[SPACE_MASS] = frame.base[SPACE_LOCAL] + tables->local_count;
  frame.base[SPACE_SIDE] = frame.base[SPACE_MASS] + tables->mass_count;
  frame.base[SPACE_ACCELERATION] = frame.base[SPACE_SIDE] + tables->side_count;
  return frame;
}

void instructions_seed(struct Frame *frame, const struct Seed *seed) {
  frame->base[SPACE_SEED_PARAMETER] = (double *)seed->parameter;
  frame->base[SPACE_SEED_STATE] = (double *)seed->state;
  frame->base[SPACE_SEED_INPUT] = (double *)seed->input;
  frame->base[SPACE_SEED_TIME] = (double *)&seed->time;
  frame->base[SPACE_SEED_RESULT] = (double *)seed->result;
}

static inline double *at(double *const *base, Place place) {
  return base[place >> PLACE_BITS] + (place & INDEX_MASK);
}

/* Returns 0, or the number of the coordinate in which the block is singular. */
static int factor(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  double *mass = frame->base[SPACE_MASS] + block->first_mass;
  size_t singular = block->factor != NULL
                        ? block->factor(block->count, block->start, block->column, block->coordinate, mass)
                        : ldlt_factor(block->count, block->start, block->column, mass);
  return singular == 0 ? 0 : block->coordinate[singular - 1];
}

static void solve(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  double *mass = frame->base[SPACE_MASS] + block->first_mass, *side = frame->base[SPACE_SIDE] + block->first_side;
  if (block->solve_obliquely != NULL)
    block->solve_obliquely(block->count, block->start, block->column, block->coordinate, mass, side);
  else if (block->solve != NULL) block->solve(block->count, block->start, block->column, mass, side);
  else ldlt_solve(block->count, block->start, block->column, mass, side);
}

static void take_least_forces(const struct Frame *frame, size_t number) {
  const struct BlockTable *block = &frame->tables->blocks[number];
  block->least_forces(block->count, block->start, block->column, block->coordinate,
                      frame->base[SPACE_MASS] + block->first_mass, frame->base[SPACE_SIDE] + block->first_side);
}

enum { SPACE_MASK = (1 << SPACE_BITS) - 1 };

/*
 * Ends a case: does the same for all count instructions of a run, of so many words each, which name the result R and the
 * operands A, B and C in their spaces. Of series, these are coefficients k, and ROW_R the whole row.
 */
#define EACH(size, ...)                                                                                                \
  for (; count > 0; count--, code += (size)) __VA_ARGS__;                                                              \
  break
#define R r[code[0]]
#define A a[code[1]]
#define B b[code[2]]
#define C c[code[3]]
#define ROW_R (row_r + code[0])
#define ROW_A (row_a + code[1])
#define ROW_B (row_b + code[2])
#define ROW_C (row_c + code[3])

/* Of the operand with this number, 0 for the result, in all instructions of a run. */
static inline uint32_t space_of_operand(uint32_t spaces, int number) {
  return spaces >> number * SPACE_BITS & SPACE_MASK;
}

int instructions_run(const struct Frame *frame, const uint32_t *code) {
  double *const *base = frame->base;
  for (;;) {
    enum Opcode opcode = (enum Opcode)code[0];
    if (opcode == END) return 0;
    uint32_t count = code[1], spaces = code[2];
    double *r = base[space_of_operand(spaces, 0)];
    const double *a = base[space_of_operand(spaces, 1)], *b = base[space_of_operand(spaces, 2)];
    code += 3;
    switch (opcode) {
    case COPY: EACH(2, R = A);
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
    case LESS_THAN: EACH(3, R = A < B ? 1.0 : 0.0);
    case GATE_OF: EACH(3, R = A > 0.0 ? B : 0.0);
    case SIGN_OF: EACH(2, R = A > 0.0 ? 1.0 : A < 0.0 ? -1.0 : 0.0);
    case CALL: {
      double (*function)(double) = frame->tables->functions[*code++];
      EACH(2, R = function(A));
    }
    case CALL_OF_TWO: {
      double (*function)(double, double) = frame->tables->functions_of_two[*code++];
      EACH(3, R = function(A, B));
    }
    case CHECK_POSITIVE: EACH(2, if (!(A > 0.0)) return (int)code[0]);
    case CHECK_PIVOT: EACH(3, if (!(A > 1e-14 * B)) return (int)code[0]);
    case CHECK_DIAGONAL: EACH(3, if (!(A > 1e-28 * B)) return (int)code[0]);
    case FACTOR:
      for (; count > 0; count--) {
        int singular = factor(frame, *code++);
        if (singular != 0) return singular;
      }
      break;
    case SOLVE: EACH(1, solve(frame, code[0]));
    case LEAST_FORCES: EACH(1, take_least_forces(frame, code[0]));
    default: return -1; /* lagc writes no other */
    }
  }
}

/* The same with code of its own for each order. */
#define EACH_OF_ORDER(size, order, ...)                                                                                \
  case (order): {                                                                                                      \
    enum { K = (order) };                                                                                              \
    for (; count > 0; count--, code += (size)) __VA_ARGS__;                                                            \
    break;                                                                                                             \
  }
#define EACH_UNROLLED(size, ...)                                                                                       \
  switch (k) {                                                                                                         \
    EACH_OF_ORDER(size, 1, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 2, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 3, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 4, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 5, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 6, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 7, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 8, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 9, __VA_ARGS__)                                                                                \
    EACH_OF_ORDER(size, 10, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 11, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 12, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 13, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 14, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 15, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 16, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 17, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 18, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 19, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 20, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 21, __VA_ARGS__)                                                                               \
    EACH_OF_ORDER(size, 22, __VA_ARGS__)                                                                               \
  default: break;                                                                                                      \
  }                                                                                                                    \
  break

void instructions_run_order(const struct Frame *frame, const uint32_t *code, int k) {
  double *const *base = frame->base;
  for (;;) {
    enum Opcode opcode = (enum Opcode)code[0];
    if (opcode == END) return;
    uint32_t count = code[1], spaces = code[2];
    const uint32_t space_r = space_of_operand(spaces, 0), space_a = space_of_operand(spaces, 1);
    const uint32_t space_b = space_of_operand(spaces, 2), space_c = space_of_operand(spaces, 3);
    double *const row_r = base[space_r], *const r = row_r + (space_r >= SPACE_ROW ? k : 0);
    const double *const row_a = base[space_a], *const a = row_a + (space_a >= SPACE_ROW ? k : 0);
    const double *const row_b = base[space_b], *const b = row_b + (space_b >= SPACE_ROW ? k : 0);
    const double *const row_c = base[space_c], *const c = row_c + (space_c >= SPACE_ROW ? k : 0);
    code += 3;
    switch (opcode) {
    case SERIES_COPY: EACH(2, R = A);
    case SERIES_ZERO: EACH(1, R = 0.0);
    case SERIES_SUM: EACH(3, R = A + B);
    case SERIES_DIFFERENCE: EACH(3, R = A - B);
    case SERIES_NEGATION: EACH(2, R = -A);
    case SERIES_GATE: EACH(3, R = *ROW_A > 0.0 ? B : 0.0);
    case SERIES_MULTIPLE: EACH(3, R = *ROW_A * B);
    case SERIES_SHARE: EACH(3, R = A / *ROW_B);
    case SERIES_PRODUCT: EACH_UNROLLED(3, R = series_product(K, ROW_A, ROW_B));
    case SERIES_SQUARE: EACH_UNROLLED(2, R = series_square(K, ROW_A));
    case SERIES_QUOTIENT: EACH(4, R = series_quotient(k, A, *ROW_C, ROW_B, ROW_R));
    case SERIES_ROOT: EACH(2, R = series_root(k, ROW_A, ROW_R));
    case SERIES_POWER: EACH(3, R = series_power(k, *ROW_B, ROW_A, ROW_R));
    case SERIES_RATE: EACH(2, (&R)[-1] = k * A);
    case SERIES_INTEGRAL: EACH_UNROLLED(3, R = series_integral(K, ROW_A, ROW_B));
    case SERIES_NEGATIVE_INTEGRAL: EACH_UNROLLED(3, R = -series_integral(K, ROW_A, ROW_B));
    case SERIES_TURN: EACH(3, R = *ROW_A * (&B)[-1] * (1.0 / k));
    case SERIES_NEGATIVE_TURN: EACH(3, R = -(*ROW_A * (&B)[-1]) * (1.0 / k));
    case SERIES_RATIO_INTEGRAL: EACH(3, R = series_ratio_integral(k, A, ROW_B, ROW_R));
    case SERIES_AREA: EACH(3, R = series_area(k, ROW_A, ROW_B));
    case SERIES_ANGLE: EACH(4, R = series_angle(k, ROW_A, ROW_B, ROW_C, ROW_R));
    case SERIES_ABSOLUTE: EACH(2, R = series_absolute(k, ROW_A));
    case SERIES_LARGER: EACH(4, R = series_sign(k, ROW_A) > 0.0 ? B : C);
    case SERIES_SMALLER: EACH(4, R = series_sign(k, ROW_A) < 0.0 ? B : C);
    case SERIES_REST: EACH_UNROLLED(4, R = A - series_rest(K, ROW_B, ROW_C));
    case SERIES_SOLVE: EACH(1, solve(frame, code[0]));
    case SERIES_STATE: EACH(2, (&R)[1] = A * (1.0 / (k + 1)));
    case SERIES_SLOPE: EACH(2, R = (k + 1) * (&A)[1]);
    default: return; /* lagc writes no other */
    }
  }
}

#undef R
#undef A
#undef B
#undef C

void instructions_limit(const struct Frame *frame, const struct LimitCheck *checks, size_t count,
                        struct SeriesLimit *limit) {
  for (size_t i = 0; i < count; i++) {
    const struct LimitCheck *check = &checks[i];
    if (check->is_gated && !(*at(frame->base, check->opener) > 0.0)) continue;
    const double *u = at(frame->base, check->row);
    switch (check->rule) {
    case LIMIT_EXPONENTIAL: series_limit_exponential(limit, u, check->function); break;
    case LIMIT_HYPERBOLIC: series_limit_hyperbolic(limit, u, check->function); break;
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
}
