/* Functions defined by <function>. Each call parses the expression with the arguments as local names. */
#pragma once

#include "read/expressions/cursor.h"

/* A <function>, whose text is parsed at each call. */
struct NamedFunction {
  char *name, **arguments;
  size_t argument_count;
  const char *text;
  long line;                          /* on which the text begins */
  struct Dimension value;             /* of the result; unknown if the system gives no unit */
  const char *file, *origin, *prefix; /* of the defining file, as in struct Diagnostics and struct Scope */
  const struct Loop *loop;            /* innermost <for> around the definition; NULL for none */
  bool is_used;
};

/* Returns the function of this full name; NULL for none. */
struct NamedFunction *function_named(const struct Scope *scope, const char *full_name);

/* Parses the arguments of a call after its opening parenthesis. Returns the value of the function. */
struct Quantity parse_function_call(struct Parser *parser, struct NamedFunction *function);
