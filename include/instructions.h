/*
 * The instructions that a system's equations become. lagc writes those of small systems as C statements, and those of
 * large ones as tables of numbers, which instructions.c carries out.
 *
 * A table is a sequence of runs: an opcode, how many instructions of it follow, the spaces that their operands are in, in
 * CALL and CALL_OF_TWO the function's place in the tables, and then the operands of each instruction, its result first.
 * A run with the opcode END is the last. An operand is an index in its space; in rows it counts coefficients.
 */
#ifndef INSTRUCTIONS_H
#define INSTRUCTIONS_H

#include <stddef.h>
#include <stdint.h>

#include "lagrangian.h"

enum Space {
  SPACE_NUMBER,
  SPACE_PARAMETER,
  SPACE_PREPARED,
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
  SPACE_MASS,   /* elements of the blocks of M that are factored at run time, later their factors */
  SPACE_SIDE,   /* right sides for these blocks, later their solutions */
  SPACE_TARGET, /* what the function is asked for */
  SPACE_ROW,    /* the workspace of series; as a value, the coefficient 0 */
  SPACE_STATE_ROW,
  SPACE_INPUT_ROW,
  SPACE_TIME_ROW,
  SPACE_TARGET_ROW,
  SPACE_COUNT
};

/* A space and an index in it. */
typedef uint32_t Place;

enum { PLACE_BITS = 27, SPACE_BITS = 5 }; /* of the index; of each space of a run, the result's in the lowest bits */

/*
 * r is the result, a, b and c are the operands. Values are numbers; in instructions for series, k is the order, a_k a
 * coefficient and "row" the array of all coefficients. Sources: series.h.
 */
enum Opcode {
  END,
  COPY,           /* r = a */
  FIRST_SLOPE,    /* the coefficient 1 of the row a */
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
  LESS_THAN,      /* 1 where a < b, else 0 */
  SIGN_OF,        /* -1, 0 or 1 */
  GATE_OF,        /* b where a > 0, else 0 */
  CALL,           /* a function of a */
  CALL_OF_TWO,    /* a function of a and b */
  CHECK_POSITIVE, /* return the number r unless a > 0 */
  CHECK_PIVOT,    /* return the number r unless a > 1e-14 b */
  CHECK_DIAGONAL, /* return the number r unless a > 1e-28 b */
  FACTOR,         /* the block r; return the coordinate's number where it is singular */
  SOLVE,          /* the block r */
  LEAST_FORCES,   /* of the solution of the block r, which has constraints */
  SERIES_COPY,    /* a_k */
  SERIES_ZERO,    /* 0 */
  SERIES_SUM,     /* a_k + b_k */
  SERIES_DIFFERENCE,
  SERIES_NEGATION,
  SERIES_MULTIPLE,          /* the value a times b_k */
  SERIES_SHARE,             /* a_k over the value b */
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
  SERIES_AREA,              /* the coefficient k - 1 of a' b - b' a over k, rows */
  SERIES_ANGLE,             /* atan2 of the rows a and b, with the row c = a^2 + b^2 */
  SERIES_ABSOLUTE,          /* of the row a */
  SERIES_LARGER,            /* b_k where the row a is positive at first, else c_k */
  SERIES_SMALLER,           /* b_k where the row a is negative at first, else c_k */
  SERIES_GATE,              /* b_k where the value a is positive, else 0 */
  SERIES_REST,              /* a_k - the product of the rows b and c without b_0 c_k */
  SERIES_SOLVE,             /* the block r */
  SERIES_STATE,             /* r_(k+1) = a_k / (k + 1) */
  SERIES_SLOPE,             /* (k + 1) a_(k+1) of the row a */
  OPCODE_COUNT
};

/* A block of M that is factored at run time: its part of the spaces, the pattern of its factor, see ldlt.h. */
struct BlockTable {
  size_t count, first_mass, first_side;
  const size_t *start, *column; /* NULL where the pattern is full */
  const int *coordinate;        /* of each row: 1 + its number; of a constraint -1 - its number */
  /* saddle_factor(), saddle_solve() and saddle_least_forces() of a block with constraints, NULL of others */
  size_t (*factor)(size_t n, const size_t *start, const size_t *column, const int *coordinate, double *m);
  void (*solve)(size_t n, const size_t *start, const size_t *column, const double *m, double *x);
  void (*least_forces)(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                       double *x);
  /* oblique_solve() of a block with forces that follow from others, NULL of others */
  void (*solve_obliquely)(size_t n, const size_t *start, const size_t *column, const int *coordinate, const double *m,
                          double *x);
};

/* What all tables of a system share. */
struct InstructionTables {
  const double *numbers;
  double (*const *functions)(double);
  double (*const *functions_of_two)(double, double);
  const struct BlockTable *blocks;
  size_t local_count, mass_count, side_count; /* the workspace holds these, then the accelerations */
};

/* Where the spaces are while a function runs. */
struct Frame {
  double *base[SPACE_COUNT];
  const struct InstructionTables *tables;
};

/* The spaces of a point, and those inside its workspace; the function's own ones are NULL. */
struct Frame instructions_frame(const struct InstructionTables *tables, const struct Point *point);

/* Adds the spaces of a direction. */
void instructions_seed(struct Frame *frame, const struct Seed *seed);

/* Carries out a table of values. Returns 0, or what a check returned. */
int instructions_run(const struct Frame *frame, const uint32_t *code);

/* Carries out a table of series for the order k. */
void instructions_run_order(const struct Frame *frame, const uint32_t *code, int k);

/* What shortens a step: one function of series_limit.h with its arguments. */
enum LimitRule {
  LIMIT_EXPONENTIAL,
  LIMIT_HYPERBOLIC,
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

struct LimitCheck {
  enum LimitRule rule;
  Place row, other_row;
  const char *function; /* the name for messages */
  double share;
  Place exponent;
  bool is_gated; /* matters only where the value of the opener is positive */
  Place opener;
};

void instructions_limit(const struct Frame *frame, const struct LimitCheck *checks, size_t count,
                        struct SeriesLimit *limit);

#endif
