/*
 * The properties of each operation, one row for each: parser, units, algebra, derivatives, Taylor series and C code use
 * it. A new elementary function needs a value of enum Operation and a row in functions.c.
 */
#pragma once

#include "algebra/graph.h"

/* f(-x) is f(x) of an even function, -f(x) of an odd one. */
enum Parity { NEITHER_ODD_NOR_EVEN, ODD, EVEN };

/* Units of arguments, and of the value. */
enum UnitRule {
  PURE_NUMBERS, /* arguments are numbers or angles; the value is a number */
  UNIT_KEPT,    /* arguments have one unit, which the value has too */
  UNIT_LOST     /* arguments have one unit; the value is a number */
};

/* Real numbers for which a function has a real value. CLOSED and OPEN: an interval with or without its ends. */
enum DomainKind { EVERYWHERE, CLOSED, OPEN };

/* The numbers from low to high, unless the kind is EVERYWHERE. */
struct Domain {
  enum DomainKind kind;
  double low, high;
};

/*
 * Recurrence by which the Taylor coefficients of y = f(x) follow from those of x and of an auxiliary expression a.
 * INTEGRAL and RATIO also give the derivative of f; the others have partial_derivatives.
 */
enum Recurrence {
  ARITHMETIC,         /* sums, products and powers, each by its own rule */
  INTEGRAL,           /* y' = sign x' a */
  RATIO,              /* y' = sign x' / a */
  ANGLE,              /* of atan2(y, x): a = x^2 + y^2, a angle' = y' x - x' y */
  REFLECTION,         /* abs: x or -x, by the sign of a = x */
  CHOICE,             /* min and max: one of the operands, by the sign of a = left - right */
  PIECEWISE_CONSTANT, /* y' = 0 except where the sign of a changes */
  GUARDED             /* the coefficients of the right operand, or 0 */
};

/* A row of the table: the properties of one operation. */
struct Function {
  const char *name;                 /* in formulas and messages, and in the language unless is_internal */
  bool is_internal;                 /* the language has no such function */
  const char *c_name;               /* name in C's math library or include/ if it differs; see function_in_c() */
  double (*of_one)(double);         /* value on numbers; both are NULL for leaves */
  double (*of_two)(double, double); /* exactly one is set, by the number of operands */

  enum Parity parity;
  bool is_never_negative; /* where it is real */
  enum UnitRule units;
  struct Domain domain;    /* of the left operand. POWER: of a base whose exponent is not whole */
  const char *domain_text; /* completes "expected an argument ..." for a value not finite; NULL if it overflows */

  enum Recurrence recurrence;
  bool is_reversed;                                  /* of INTEGRAL and RATIO: sign is -1 instead of 1 */
  Node (*auxiliary)(struct Graph *graph, Node node); /* returns a, perhaps the node or an operand; ZERO for none */
  void (*partial_derivatives)(struct Graph *graph, Node node, Node *by_left, Node *by_right); /* NULL: see above */

  bool has_pieces;          /* has a kink or jump where a changes its sign; each piece has a series */
  enum Operation folded[2]; /* this function of one of those is piecewise linear, with kinks that no series shows */
  const char *fold_name;    /* name of that composition, such as "asin of a sine"; NULL for none */

  /* Functions of include/series_limit.h, without "series_limit_", that bound the step by a series; NULL for none. */
  const char *operand_limit, *auxiliary_limit;
};

/* One row for each operation. */
extern const struct Function functions[OPERATION_COUNT];

/* Returns the name of a function in C. */
static inline const char *function_in_c(enum Operation operation) {
  const struct Function *row = &functions[operation];
  return row->c_name != NULL ? row->c_name : row->name;
}

/* Returns the sign in the rules INTEGRAL and RATIO. */
static inline double recurrence_sign(const struct Function *row) {
  return row->is_reversed ? -1.0 : 1.0;
}
