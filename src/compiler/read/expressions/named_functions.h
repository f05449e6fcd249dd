/* Functions that a system defines by an expression of their arguments, which stands wherever they are called. */
#pragma once

#include "read/expressions/cursor.h"

struct NamedFunction {
  char *name, **arguments;
  size_t argument_count;
  const char *text;                   /* the expression */
  long line;                          /* where it begins */
  struct Dimension value;             /* unknown where the system gives no unit */
  const char *file, *origin, *prefix; /* in which it stands; as in struct Diagnostics and struct Scope */
  const struct Loop *loop;            /* around it; NULL for none */
  bool is_used;
};

/* The function of this full name; NULL where there is none. */
struct NamedFunction *function_named(const struct Scope *scope, const char *full_name);

/* The value of a function at the reading position, behind the parenthesis that opens its arguments. */
struct Quantity parse_function_call(struct Parser *parser, struct NamedFunction *function);
