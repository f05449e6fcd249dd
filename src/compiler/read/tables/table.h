/* Functions of one or two variables that are given by points. */
#pragma once

#include "read/tables/curve.h"
#include "read/tables/surface.h"

struct Table {
  bool has_two_arguments;
  struct Curve curve;     /* of one */
  struct Surface surface; /* of two */
  bool is_constant_outside;
  struct Dimension arguments[2], value;
};

/* The table of this full name; NULL where there is none. */
const struct Table *table_named(const struct Scope *scope, const char *full_name);

/* The table at its one or two arguments, an expression of pieces.h; line: where it is used. */
Node table_at(struct Scope *scope, const struct Table *table, const Node arguments[2], long line);
