/*
 * The instructions to which a system's equations are compiled. lagc writes them as C statements for small systems, and
 * as tables of numbers for large ones, which instructions.c interprets.
 *
 * A table is a sequence of runs. A run is an opcode, the number of its instructions, and the spaces of their operands;
 * for CALL and CALL_OF_TWO the index of the function follows. The results are equally spaced: the first one comes, and
 * the difference to the next. Then come the operands of the first instruction, and for each other one the differences to
 * those before. The opcode END ends the table. Results and operands are indices in their spaces; in rows of series these
 * count coefficients.
 *
 * SPACED, in the number of instructions, marks a run whose operands are equally spaced too. Of each the first one comes,
 * and the difference to the next.
 *
 * SKIP has the number of words of its region in place of that of instructions. Then come its operand and the region,
 * which is a sequence of runs.
 */
#ifndef INSTRUCTIONS_H
#define INSTRUCTIONS_H

#include <stddef.h>
#include <stdint.h>

#include "lagrangian.h"

/*
 * Arrays that instructions read and write; instructions_frame() and instructions_seed() set their addresses. SEED
 * spaces hold the direction of a directional derivative, ROW spaces rows of Taylor coefficients. SPACE_LOCAL holds
 * local variables.
 */
enum Space {
  SPACE_NUMBER,
  SPACE_PARAMETER,
  SPACE_PARAMETER_CONSTANTS,
  SPACE_STATE,
  SPACE_INPUT,
  SPACE_TIME,
  SPACE_ACCELERATION,
  SPACE_SEED_PARAMETER,
  SPACE_SEED_STATE,
  SPACE_SEED_INPUT,
  SPACE_SEED_TIME,
  SPACE_SEED_ACCELERATION,
  SPACE_SEED_RESULT,
  SPACE_LOCAL,
  SPACE_MASS,       /* elements of the blocks of M that are factored at run time, later their factors */
  SPACE_RIGHT_SIDE, /* right sides of these blocks, later their solutions */
  SPACE_TARGET,     /* the result array of the function */
  SPACE_ROW,        /* the workspace of series; as a value, coefficient 0 */
  SPACE_STATE_ROW,
  SPACE_INPUT_ROW,
  SPACE_TIME_ROW,
  SPACE_TARGET_ROW,
  SPACE_COUNT
};

/* A space in the upper 5 bits, and an index in it. */
typedef uint32_t Slot;

/*
 * SLOT_BITS: of the index in a Slot. SPACE_BITS: of each space in the header of a run, that of the result in the lowest
 * bits.
 */
enum { SLOT_BITS = 27, SPACE_BITS = 5 };

/* In the number of instructions of a run, see above. */
#define SPACED 0x40000000

/*
 * r is the result, a, b and c are the operands. Values are numbers. In instructions for series, k is the order, a_k a
 * coefficient, and "row" the array of all coefficients; series.h has the recurrences.
 */
enum Opcode {
  END,
  COPY,           /* r = a */
  FIRST_SLOPE,    /* coefficient 1 of the row a */
  SUM,            /* a + b */
  DIFFERENCE,     /* a - b */
  PRODUCT,        /* a b */
  QUOTIENT,       /* a / b */
  NEGATION,       /* -a */
  SQUARE,         /* a^2 */
  CUBE,           /* a^3 */
  FOURTH,         /* a^4 */
  RECIPROCAL,     /* 1 / a */
  INVERSE_SQUARE, /* a^-2 */
  INVERSE_CUBE,   /* a^-3 */
  INVERSE_FOURTH, /* a^-4 */
  SQUARE_ROOT,    /* sqrt(a) */
  INVERSE_ROOT,   /* 1 / sqrt(a) */
  LESS_THAN,      /* 1 if a < b, else 0 */
  SIGN_OF,        /* -1, 0 or 1 */
  GUARD_OF,       /* b if a > 0, else 0 */
  CALL,           /* a function of a */
  CALL_OF_TWO,    /* a function of a and b */
  CHECK_POSITIVE, /* return r unless a > 0 */
  CHECK_PIVOT,    /* return r unless a > 1e-14 b */
  CHECK_DIAGONAL, /* return r unless a > 1e-28 b */
  FACTOR,         /* factors block r; returns the number of the coordinate in which it is singular */
  SOLVE,          /* solves block r */
  LEAST_FORCES,   /* least-norm constraint forces in the solution of block r */
  SKIP,           /* skips the region that follows unless a > 0 */
  SERIES_COPY,    /* a_k */
  SERIES_ZERO,    /* 0 */
  SERIES_SUM,     /* a_k + b_k */
  SERIES_DIFFERENCE,
  SERIES_NEGATION,
  SERIES_MULTIPLE,          /* the value a times b_k */
  SERIES_SHARE,             /* a_k divided by the value b */
  SERIES_PRODUCT,           /* of the rows a and b */
  SERIES_SQUARE,            /* of the row a */
  SERIES_QUOTIENT,          /* a_k, the row b, the value c = 1 / b_0 */
  SERIES_ROOT,              /* of the row a */
  SERIES_POWER,             /* of the row a, with the value b as exponent */
  SERIES_RATE,              /* r_(k-1) = k a_k */
  SERIES_INTEGRAL,          /* r' = a b, rows */
  SERIES_NEGATIVE_INTEGRAL, /* r' = -a b, rows */
  SERIES_TURN,              /* r' = a b, the value a and the row b */
  SERIES_NEGATIVE_TURN,     /* r' = -a b, the value a and the row b */
  SERIES_RATIO_INTEGRAL,    /* r' = a' / b, with a_k and the row b */
  SERIES_AREA,              /* coefficient k - 1 of a' b - b' a, divided by k; rows */
  SERIES_ANGLE,             /* atan2 of the rows a and b, with the row c = a^2 + b^2 */
  SERIES_ABSOLUTE,          /* of the row a */
  SERIES_LARGER,            /* b_k if the row a is positive just after t = 0, else c_k */
  SERIES_SMALLER,           /* b_k if the row a is negative just after t = 0, else c_k */
  SERIES_GUARD,             /* b_k if the value a is positive, else 0 */
  SERIES_REST,              /* a_k minus the product of the rows b and c without its term b_0 c_k */
  SERIES_SOLVE,             /* solves block r */
  SERIES_STATE,             /* r_(k+1) = a_k / (k + 1) */
  SERIES_SLOPE,             /* (k + 1) a_(k+1) of the row a */
  OPCODE_COUNT
};

/*
 * A block of M that is factored at run time: its slices of SPACE_MASS and SPACE_RIGHT_SIDE, and the pattern of its
 * factor as in ldlt.h.
 */
struct BlockTable {
  size_t count, first_mass, first_right_side;
  const size_t *start, *column; /* of ldlt.h or saddle.h; NULL for a full pattern */
  const int *coordinate;        /* of each row: 1 + the index of the coordinate; -1 - that of a constraint */
  /* saddle_factor(), saddle_solve() and saddle_least_forces() for a block with constraints; else NULL */
  size_t (*factor)(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m);
  void (*solve)(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x);
  void (*least_forces)(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                       Real *x);
  /* nonsymmetric_solve() for a block with forces that depend on constraint forces; else NULL */
  void (*solve_nonsymmetric)(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                             Real *x);
};

/* Data shared by all tables of a system. */
struct InstructionTables {
  const Real *numbers;
  Real (*const *functions)(Real);
  Real (*const *functions_of_two)(Real, Real);
  const struct BlockTable *blocks;
  size_t local_count, mass_count,
      right_side_count; /* sizes of the spaces in the workspace, which the accelerations follow */
};

/* Base addresses of the spaces while a function runs. */
struct Frame {
  Real *base[SPACE_COUNT];
  const struct InstructionTables *tables;
};

/* Returns a frame with the spaces of a point and of its workspace. Those of the function itself are NULL. */
struct Frame instructions_frame(const struct InstructionTables *tables, const struct Point *point);

/* Sets the spaces of a seed. */
void instructions_seed(struct Frame *frame, const struct Seed *seed);

/* Runs a table of values. Returns 0, or the number of the first check or factorization that fails. */
int instructions_run(const struct Frame *frame, const int32_t *code);

/* Runs a table of series at order k. */
void instructions_run_order(const struct Frame *frame, const int32_t *code, int k);

/* A bound on the step: one function of series_limit.h with its arguments. */
enum LimitRule {
  LIMIT_EXPONENTIAL,
  LIMIT_HYPERBOLIC,
  LIMIT_BOUNDED,
  LIMIT_TANH,
  LIMIT_TANGENT,
  LIMIT_POSITIVE,
  LIMIT_QUOTIENT,
  LIMIT_ROOT,
  LIMIT_WHOLE_POWER,
  LIMIT_DIVISION,
  LIMIT_POWER,
  LIMIT_SIGN,
  LIMIT_ANGLE,
  LIMIT_RULE_COUNT
};

/* A rule with its arguments: the row of the argument; for some rules a second row, a share or an exponent. */
struct LimitCheck {
  enum LimitRule rule;
  Slot row, other_row;
  const char *function; /* name for messages */
  double share;
  Slot exponent;
  bool is_guarded; /* applies only if the value of guard_condition is positive */
  Slot guard_condition;
};

/* Bounds the step in `limit` by `count` checks of a table, for the rows of the frame's series. */
void instructions_limit(const struct Frame *frame, const struct LimitCheck *checks, size_t count,
                        struct SeriesLimit *limit);

#endif
