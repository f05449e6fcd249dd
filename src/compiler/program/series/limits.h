/* How far a step may go by the elementary functions in the series; see series_limit.h. */
#pragma once

#include "instructions.h"
#include "program/series/series_builder.h"

struct LimitChecks {
  struct LimitCheck *items; /* the functions' names are static strings */
  size_t count;
};

/* The function series_limit_NAME() of a rule, and what it is called with after the first row. */
struct LimitFacts {
  const char *name;
  bool has_two_rows, has_function, has_exponent, has_share;
};

const struct LimitFacts *limit_facts(enum LimitRule rule);

/* The checks for all nodes of the series, whose operands have rows from now on. */
struct LimitChecks limits_of(struct SeriesBuilder *builder);
