/* What the parts of a series program share while it is built. */
#pragma once

#include "program/expressions/series_plan.h"
#include "program/values/form.h"
#include "algebra/node_list.h"
#include "program/values/routine.h"
#include "program/values/values.h"

/* Spaces of a routine that is not complete yet: only then is known which nodes have rows. */
enum {
  SPACE_OF_NODES = SPACE_COUNT, /* the series of a node */
  SPACE_OF_ACCELERATIONS,       /* the row of an acceleration */
  SPACE_OF_RATES,               /* a row of the time derivative of a node, or of an inverse */
  SPACE_OF_FACTORS,             /* local variables without a node */
};

struct SeriesBuilder {
  const struct Graph *graph;
  const struct SeriesPlan *plan;
  size_t coordinates;
  struct Needs *needs;
  const struct Values *values; /* for the places of what is constant in time */
  struct Routine *order;
  struct NodeList nodes; /* those that are computed, ascending */
  bool *is_computed;     /* for each node of the graph */
  bool *has_row;         /* for each node of the graph */
  bool *is_done;         /* for each node of the graph: its instructions are there */
  size_t *rate;          /* for each node: 1 + the number of its time derivative's row, 0 for none */
  size_t *inverse;       /* for each node: 1 + the number of the row that holds 1 / its first coefficient */
  size_t further_rows;   /* of both */
  size_t factor_count;
};

/* Whether all coefficients but the first are 0. */
bool is_constant_series(const struct SeriesBuilder *builder, Node node);

/* The coefficients of a node that changes in time. From series_row() on it has a row. */
Place series_coefficient(const struct SeriesBuilder *builder, Node node);
Place series_row(struct SeriesBuilder *builder, Node node);

/* The operand whose time derivative the node's recurrence needs; ZERO for none. */
Node integrated_operand(const struct SeriesBuilder *builder, Node node);

/* Whether the node is a power with an exponent that varies, whose coefficients rest on its auxiliary node alone. */
bool is_integrated_power(const struct SeriesBuilder *builder, Node node);

/* Appends the coefficient k of the node, whose operands have theirs. */
void append_recurrence(struct SeriesBuilder *builder, Node node);
