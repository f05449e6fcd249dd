/* Checks that limit a step by the series of the arguments of elementary functions; see include/series_limit.h. */
#pragma once

#include "instructions.h"
#include "program/series/series_builder.h"

/* Checks, in the order in which the runtime makes them. */
struct LimitChecks {
  struct LimitCheck *items; /* the names of functions in them are static strings */
  size_t count;
};

/* The function series_limit_NAME() of a rule, and its arguments after the first row. */
struct LimitMetadata {
  const char *name;
  bool has_two_rows, has_function, has_exponent, has_share;
};

/* Returns the row of the rule in the table, which is static. */
const struct LimitMetadata *limit_metadata(enum LimitRule rule);

/* Returns the checks of all nodes in the series; their arguments get rows. */
struct LimitChecks limits_of(struct SeriesBuilder *builder);
