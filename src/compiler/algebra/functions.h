/*
 * What the compiler knows of an operation, in one row: parser, units, algebra, derivatives, Taylor series and C code
 * all follow from it. A new elementary function is one value of enum Operation and one row in functions.c.
 */
#pragma once

#include "algebra/graph.h"

enum Parity { NEITHER_ODD_NOR_EVEN, ODD, EVEN };

/* What a function asks of the units of its arguments, and the unit of its value. */
enum UnitRule {
  PURE_NUMBERS, /* numbers or angles give a number */
  UNIT_KEPT,    /* arguments of one unit give a value of that unit */
  UNIT_LOST     /* arguments of one unit give a number */
};

/* The real numbers for which a function has a real value. */
enum DomainKind { EVERYWHERE, CLOSED, OPEN };

struct Domain {
  enum DomainKind kind; /* whether the ends belong to it */
  double low, high;
};

/*
 * How the Taylor coefficients of y = f(x) come from those of x, and of an auxiliary expression a. INTEGRAL and RATIO
 * give the derivative of f as well; the others have partial derivatives of their own.
 */
enum Recurrence {
  ARITHMETIC,         /* sums, products and powers, by the rules for each */
  INTEGRAL,           /* y' = sign x' a */
  RATIO,              /* y' = sign x' / a */
  ANGLE,              /* of atan2(y, x): a = x^2 + y^2, a angle' = y' x - x' y */
  REFLECTION,         /* abs: x or -x, by the sign of a = x */
  CHOICE,             /* min and max: one of the operands, by the sign of a = left - right */
  PIECEWISE_CONSTANT, /* y' = 0 but where the sign of a changes */
  GATED               /* the coefficients of the right operand, or 0 */
};

struct Function {
  const char *name;                 /* in formulas and messages; in the language too, unless it is internal */
  bool is_internal;                 /* the language has no function of this name */
  const char *c_name;               /* in C's math library or include/, where it is another; see function_in_c() */
  double (*of_one)(double);         /* the value on numbers; both are NULL for leaves */
  double (*of_two)(double, double); /* either this or of_one is given, which tells the number of operands */

  enum Parity parity;
  bool is_never_negative; /* where it is real */
  enum UnitRule units;
  struct Domain domain;    /* of the left operand. POWER: of a base whose exponent is no whole number */
  const char *domain_text; /* completes "expected an argument ...", for a value that is not finite; NULL: overflows */

  enum Recurrence recurrence;
  bool is_reversed;                                  /* of INTEGRAL and RATIO: the sign is -1, else 1 */
  Node (*auxiliary)(struct Graph *graph, Node node); /* a; may be the node itself or an operand; ZERO for none */
  void (*partial_derivatives)(struct Graph *graph, Node node, Node *by_left, Node *by_right); /* NULL: see above */

  bool has_pieces;          /* a kink or a jump, where the auxiliary changes its sign; each piece has a series */
  enum Operation folded[2]; /* this function of one of those is piecewise linear, and no series sees where it turns */
  const char *fold_name;    /* of that kink, such as "asin of a sine"; NULL for none */

  /* The functions of include/series_limit.h, without "series_limit_", that shorten a step by a series; NULL for none. */
  const char *operand_limit, *auxiliary_limit;
};

/* One row for each operation. */
extern const struct Function functions[OPERATION_COUNT];

/* The name of a function that C calls. */
static inline const char *function_in_c(enum Operation operation) {
  const struct Function *row = &functions[operation];
  return row->c_name != NULL ? row->c_name : row->name;
}

/* That of INTEGRAL and RATIO. */
static inline double recurrence_sign(const struct Function *row) {
  return row->is_reversed ? -1.0 : 1.0;
}
