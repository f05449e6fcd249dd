/* Tables: functions of one or two arguments that interpolate given points. */
#pragma once

#include "read/tables/curve.h"
#include "read/tables/surface.h"

/* A table, with one or two arguments. */
struct Table {
  bool has_two_arguments;
  struct Curve curve;          /* if there is one argument */
  struct SurfaceTable surface; /* if there are two */
  bool is_constant_outside;
  struct Dimension arguments[2], value;
};

/* Returns the table of this full name; NULL for none. */
const struct Table *table_named(const struct Scope *scope, const char *full_name);

/* Returns the table at its one or two arguments as an expression of piecewise.h. line: of its use, for messages. */
Node table_at(struct Scope *scope, const struct Table *table, const Node arguments[2], long line);
