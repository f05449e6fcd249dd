/* C for one coefficient of one series: a recurrence of series.h, or a sum of coefficients. */
#ifndef RECURRENCES_H
#define RECURRENCES_H

#include "write/emitter.h"

struct SeriesWriter {
  struct Emitter *emitter;
  const struct SeriesPlan *plan;
  size_t *uses;
  size_t *row;     /* for each node: 1 + its row of the workspace, 0 for none */
  bool *is_needed; /* for each node: computed, in a row or as a local variable */
  bool *is_array;  /* for each node: recurrences take all of its coefficients, so that it has a row */
  bool *done;      /* for each node: written in the current order */
  Node *nodes;     /* those that are needed, ascending */
  size_t *inverse; /* for each node: 1 + the row of the inverse of its first coefficient, 0 for none */
  size_t *rate;    /* for each node: 1 + the row of its time derivative, 0 for none */
  size_t node_count, row_count, acceleration_row, factor_row, recurrences;
  char *order_text; /* the statements for coefficient k */
  bool has_acceleration_rows, keeps_factors, is_unrolled;
};

/* Whether all coefficients but the first are 0. */
bool is_constant_series(const struct SeriesWriter *writer, Node node);

/*
 * The array of a node's coefficients: a row of the workspace, of the state, of the inputs, or the time's. Marks the node
 * as an array.
 */
void write_row(struct SeriesWriter *writer, Node node);

/* The coefficient k >= 1 of an operand: an element of its row, or the local variable of a node without one. */
void write_coefficient(const struct SeriesWriter *writer, Node node);

/* The operand whose time derivative the node's recurrence needs; ZERO for none. */
Node integrated_operand(const struct SeriesWriter *writer, Node node);

/* A statement for coefficient k - 1 of the operand's time derivative, once for all functions of the operand. */
void write_rate(struct SeriesWriter *writer, Node operand);

/* The coefficient k of the node. */
void write_value(struct SeriesWriter *writer, Node node);

#endif
