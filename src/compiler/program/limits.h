/* How far a step may go by the elementary functions in the series; see series_limit.h. */
#ifndef LIMITS_H
#define LIMITS_H

#include "instructions.h"
#include "program/series_builder.h"

struct LimitChecks {
  struct LimitCheck *items; /* the functions' names are static strings */
  size_t count;
};

/* The checks for all nodes of the series, whose operands have rows from now on. Free items with free(). */
struct LimitChecks limits_of(struct SeriesBuilder *builder);

#endif
