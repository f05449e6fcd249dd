/* State shared while a series program is built. */
#pragma once

#include "program/expressions/series_plan.h"
#include "program/codegen/fused_operations.h"
#include "algebra/node_list.h"
#include "program/codegen/ir.h"
#include "program/codegen/code_generator.h"

/* Provisional spaces of slots (ir.h), which become final when it is known which nodes have rows. */
enum {
  SPACE_OF_NODES = SPACE_COUNT, /* the series of a node */
  SPACE_OF_ACCELERATIONS,       /* the row of an acceleration */
  SPACE_OF_RATES,               /* the row of the time derivative of a node, or of an inverse */
  SPACE_OF_FACTORS,             /* local variables without a node */
};

/* State while the instructions of an order are appended. */
struct SeriesBuilder {
  const struct Graph *graph;
  const struct SeriesPlan *plan;
  size_t coordinates;
  struct NeededNodes *needs;
  const struct CodeGenerator *generator; /* for the slots of values that are constant in time */
  struct IrFunction *order;
  struct NodeList nodes; /* the computed nodes, ascending */
  bool *is_computed;     /* for each node of the graph, as the next two */
  bool *has_row;         /* all its coefficients are kept */
  bool *is_done;         /* its instructions are appended */
  size_t *rate;          /* for each node: 1 + the index of its time derivative's row, 0 for none */
  size_t *inverse;       /* for each node: 1 + the index of the row with 1 / its coefficient 0, 0 for none */
  size_t further_rows;   /* number of both kinds of rows */
  size_t factor_count;
};

/* True if all coefficients but the first are 0. */
bool is_constant_series(const struct SeriesBuilder *builder, Node node);

/* Return the slot of a node that changes in time; series_row() also keeps all its coefficients in a row. */
Slot series_coefficient(const struct SeriesBuilder *builder, Node node);
Slot series_row(struct SeriesBuilder *builder, Node node);

/* Returns the operand whose time derivative the node's recurrence needs; ZERO for none. */
Node integrated_operand(const struct SeriesBuilder *builder, Node node);

/* True if the node is a power a^b = exp(b log a) with varying b; its recurrence needs the auxiliary node b log a. */
bool is_integrated_power(const struct SeriesBuilder *builder, Node node);

/* Appends the coefficient k of the node; those of its operands must be appended before. */
void append_recurrence(struct SeriesBuilder *builder, Node node);
