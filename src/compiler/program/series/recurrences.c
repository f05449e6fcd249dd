/*
 * Taylor coefficients by recurrences. Let u(t) = sum over k of u_k t^k. Each operation gives coefficient k of its
 * result from those of its operands up to k, and of the result and auxiliary nodes below k:
 *
 *     c = a b         c_k = sum over j of a_j b_(k-j)  (Cauchy)
 *     c = a / b       c_k = (a_k - sum over j >= 1 of b_j c_(k-j)) / b_0
 *     c = a^n         a c' = n a' c
 *     exp, sin, ...   c' = a' b with an auxiliary b, as cos(a) for sin(a)  (INTEGRAL)
 *     log, asin, ...  c' = a' / b with an auxiliary b  (RATIO)
 *
 * Linear operations cost O(1) for an order, others O(k), so that all coefficients up to order K cost O(K^2). This file
 * chooses the instruction for each node; include/series.h has the recurrences. A. Griewank, A. Walther: Evaluating
 * Derivatives, 2nd ed., 2008, chapter 13; A. Jorba, M. Zou: A software package for the numerical integration of ODEs
 * by means of high-order Taylor methods, 2005.
 */
#include <math.h>

#include "algebra/functions.h"
#include "program/series/series_builder.h"
#include "program/codegen/code_generator.h"

bool is_constant_series(const struct SeriesBuilder *builder, Node node) {
  return graph_is_constant_in_time(builder->graph, node);
}

Slot series_coefficient(const struct SeriesBuilder *builder, Node node) {
  if (is_constant_series(builder, node)) return slot_at(SPACE_NUMBER, ZERO);
  if (builder->is_computed[node]) return slot_at((enum Space)SPACE_OF_NODES, node);
  const struct Symbol *symbol = graph_symbol_of(builder->graph, node);
  size_t index = (size_t)symbol->index;
  switch (symbol->kind) {
  case TIME: return slot_at(SPACE_TIME_ROW, 0);
  case INPUT: return slot_at(SPACE_INPUT_ROW, index);
  case COORDINATE: return slot_at(SPACE_STATE_ROW, index);
  case VELOCITY: return slot_at(SPACE_STATE_ROW, builder->coordinates + index);
  case STATE: return slot_at(SPACE_STATE_ROW, 2 * builder->coordinates + index);
  default: return slot_at((enum Space)SPACE_OF_ACCELERATIONS, index);
  }
}

Slot series_row(struct SeriesBuilder *builder, Node node) {
  builder->has_row[node] = true;
  return series_coefficient(builder, node);
}

static void append(struct SeriesBuilder *builder, enum Opcode opcode, Slot result, Slot a, Slot b, Slot c) {
  ir_append(builder->order, opcode, result, a, b, c);
}

/* Returns the slot of a value that is constant in time. */
static Slot value_of(const struct SeriesBuilder *builder, Node node) {
  return generator_slot(builder->generator, node);
}

static Slot new_local(struct SeriesBuilder *builder) {
  return slot_at((enum Space)SPACE_OF_FACTORS, builder->factor_count++);
}

static bool is_coordinate(const struct SeriesBuilder *builder, Node node) {
  const struct Graph *graph = builder->graph;
  return graph->vertices[node].operation == SYMBOL && graph_symbol_of(graph, node)->kind == COORDINATE;
}

/* Returns the row of the time derivative: that of a velocity, or one that all functions of the operand share. */
static Slot rate_row(struct SeriesBuilder *builder, Node operand) {
  if (is_coordinate(builder, operand))
    return slot_at(SPACE_STATE_ROW, builder->coordinates + (size_t)graph_symbol_of(builder->graph, operand)->index);
  if (builder->rate[operand] == 0) {
    builder->rate[operand] = ++builder->further_rows;
    append(builder, SERIES_RATE, slot_at((enum Space)SPACE_OF_RATES, builder->rate[operand] - 1),
           series_coefficient(builder, operand), 0, 0);
  }
  return slot_at((enum Space)SPACE_OF_RATES, builder->rate[operand] - 1);
}

static void append_product(struct SeriesBuilder *builder, Slot result, Node left, Node right) {
  if (is_constant_series(builder, left))
    append(builder, SERIES_MULTIPLE, result, value_of(builder, left), series_coefficient(builder, right), 0);
  else if (is_constant_series(builder, right))
    append(builder, SERIES_MULTIPLE, result, value_of(builder, right), series_coefficient(builder, left), 0);
  else append(builder, SERIES_PRODUCT, result, series_row(builder, left), series_row(builder, right), 0);
}

/* Appends top / below; the inverse of below's coefficient 0 has a row of its own. */
static void append_quotient(struct SeriesBuilder *builder, Node node, Node top, Node below) {
  if (is_constant_series(builder, below)) {
    append(builder, SERIES_SHARE, series_coefficient(builder, node), series_coefficient(builder, top),
           value_of(builder, below), 0);
    return;
  }
  if (builder->inverse[below] == 0) builder->inverse[below] = ++builder->further_rows;
  append(builder, SERIES_QUOTIENT, series_row(builder, node), series_coefficient(builder, top),
         series_row(builder, below), slot_at((enum Space)SPACE_OF_RATES, builder->inverse[below] - 1));
}

/* Returns the coefficient k of sign * factor * top, where factor is constant in time. */
static Slot scaled(struct SeriesBuilder *builder, double sign, Node factor, Node top) {
  Slot coefficient = series_coefficient(builder, top);
  if (factor != ONE) {
    Slot product = new_local(builder);
    append(builder, SERIES_MULTIPLE, product, value_of(builder, factor), coefficient, 0);
    coefficient = product;
  }
  if (sign < 0.0) {
    Slot negative = new_local(builder);
    append(builder, SERIES_NEGATION, negative, coefficient, 0, 0);
    coefficient = negative;
  }
  return coefficient;
}

/* Appends y' = sign factor top' / below. */
static void append_ratio_integral(struct SeriesBuilder *builder, Node node, double sign, Node factor, Node top,
                                  Node below) {
  Slot coefficient = scaled(builder, sign, factor, top);
  if (is_constant_series(builder, below))
    append(builder, SERIES_SHARE, series_coefficient(builder, node), coefficient, value_of(builder, below), 0);
  else append(builder, SERIES_RATIO_INTEGRAL, series_row(builder, node), coefficient, series_row(builder, below), 0);
}

/* Appends y' = sign operand' factor. */
static void append_integral(struct SeriesBuilder *builder, Node node, double sign, Node operand, Node factor) {
  Slot result = series_coefficient(builder, node);
  if (is_constant_series(builder, operand)) append(builder, SERIES_ZERO, result, 0, 0, 0);
  else if (is_constant_series(builder, factor))
    append(builder, SERIES_COPY, result, scaled(builder, sign, factor, operand), 0, 0);
  else if (builder->plan->slope[operand] != ZERO)
    append(builder, sign < 0.0 ? SERIES_NEGATIVE_TURN : SERIES_TURN, result,
           value_of(builder, builder->plan->slope[operand]), series_row(builder, factor), 0);
  else {
    Slot rate = rate_row(builder, operand);
    append(builder, sign < 0.0 ? SERIES_NEGATIVE_INTEGRAL : SERIES_INTEGRAL, result, rate, series_row(builder, factor),
           0);
  }
}

Node integrated_operand(const struct SeriesBuilder *builder, Node node) {
  const struct Vertex *vertex = &builder->graph->vertices[node];
  if (functions[vertex->operation].recurrence == INTEGRAL) return vertex->left;
  bool is_integrated = vertex->operation == POWER && !is_constant_series(builder, vertex->right);
  return is_integrated ? builder->plan->auxiliary[node] : ZERO;
}

bool is_integrated_power(const struct SeriesBuilder *builder, Node node) {
  return builder->graph->vertices[node].operation == POWER && integrated_operand(builder, node) != ZERO;
}

static void append_power(struct SeriesBuilder *builder, Node node, Node base, Node exponent) {
  const struct Graph *graph = builder->graph;
  Node auxiliary = builder->plan->auxiliary[node];
  Slot result = series_coefficient(builder, node);
  double n = graph_is_constant(graph, exponent) ? graph_value(graph, exponent) : NAN;
  if (n == 2.0) append(builder, SERIES_SQUARE, result, series_row(builder, base), 0, 0);
  else if (n == -1.0) append_quotient(builder, node, ONE, base);
  else if (n == 0.5) append(builder, SERIES_ROOT, series_row(builder, node), series_row(builder, base), 0, 0);
  else if (!is_constant_series(builder, exponent)) append_integral(builder, node, 1.0, auxiliary, node);
  else if (auxiliary == ZERO)
    append(builder, SERIES_POWER, series_row(builder, node), series_row(builder, base), value_of(builder, exponent), 0);
  else if (n < 0.0) append_quotient(builder, node, ONE, auxiliary);
  else if (graph_value(graph, graph->vertices[auxiliary].right) * 2.0 == n)
    append(builder, SERIES_SQUARE, result, series_row(builder, auxiliary), 0, 0);
  else append_product(builder, result, auxiliary, base);
}

/*
 * Appends c = atan2(y, x): (x^2 + y^2) c' = y' x - x' y. Any of y, x and x^2 + y^2 may be constant, the last one for a
 * rod of constant length.
 */
static void append_angle(struct SeriesBuilder *builder, Node node, Node y, Node x, Node square) {
  if (is_constant_series(builder, x)) append_ratio_integral(builder, node, 1.0, x, y, square);
  else if (is_constant_series(builder, y)) append_ratio_integral(builder, node, -1.0, y, x, square);
  else if (is_constant_series(builder, square)) {
    Slot area = new_local(builder);
    append(builder, SERIES_AREA, area, series_row(builder, y), series_row(builder, x), 0);
    append(builder, SERIES_SHARE, series_coefficient(builder, node), area, value_of(builder, square), 0);
  } else
    append(builder, SERIES_ANGLE, series_row(builder, node), series_row(builder, y), series_row(builder, x),
           series_row(builder, square));
}

/*
 * Appends the coefficients of the operand that is larger, or smaller, just after the start. If the difference of both
 * is constant, their coefficients k >= 1 are equal.
 */
static void append_choice(struct SeriesBuilder *builder, Node node, Node left, Node right, Node difference) {
  enum Opcode opcode = builder->graph->vertices[node].operation == MAXIMUM ? SERIES_LARGER : SERIES_SMALLER;
  Slot result = series_coefficient(builder, node), first = series_coefficient(builder, left);
  if (is_constant_series(builder, difference)) append(builder, SERIES_COPY, result, first, 0, 0);
  else append(builder, opcode, result, series_row(builder, difference), first, series_coefficient(builder, right));
}

static void append_function(struct SeriesBuilder *builder, Node node) {
  const struct Vertex *vertex = &builder->graph->vertices[node];
  const struct Function *function = &functions[vertex->operation];
  Node operand = vertex->left, auxiliary = builder->plan->auxiliary[node];
  switch (function->recurrence) {
  case INTEGRAL: append_integral(builder, node, recurrence_sign(function), operand, auxiliary); return;
  case RATIO: append_ratio_integral(builder, node, recurrence_sign(function), ONE, operand, auxiliary); return;
  case ANGLE: append_angle(builder, node, operand, vertex->right, auxiliary); return;
  case CHOICE: append_choice(builder, node, operand, vertex->right, auxiliary); return;
  case REFLECTION:
    append(builder, SERIES_ABSOLUTE, series_coefficient(builder, node), series_row(builder, operand), 0, 0);
    return;
  case PIECEWISE_CONSTANT: append(builder, SERIES_ZERO, series_coefficient(builder, node), 0, 0, 0); return;
  case GUARDED:
    if (is_constant_series(builder, vertex->right)) {
      append(builder, SERIES_ZERO, series_coefficient(builder, node), 0, 0, 0);
      return;
    }
    append(builder, SERIES_GUARD, series_coefficient(builder, node), value_of(builder, operand),
           series_coefficient(builder, vertex->right), 0);
    return;
  case ARITHMETIC: return; /* not a function */
  }
}

static void append_sum(struct SeriesBuilder *builder, Node node, struct FusedOperation fused) {
  Slot result = series_coefficient(builder, node);
  Slot left = series_coefficient(builder, fused.left), right = series_coefficient(builder, fused.right);
  bool is_difference = fused.kind == FUSED_DIFFERENCE;
  if (is_constant_series(builder, fused.right)) append(builder, SERIES_COPY, result, left, 0, 0);
  else if (is_constant_series(builder, fused.left))
    append(builder, is_difference ? SERIES_NEGATION : SERIES_COPY, result, right, 0, 0);
  else append(builder, is_difference ? SERIES_DIFFERENCE : SERIES_SUM, result, left, right, 0);
}

void append_recurrence(struct SeriesBuilder *builder, Node node) {
  struct FusedOperation fused = fused_operation_of(builder->needs, node);
  Slot result = series_coefficient(builder, node);
  switch (fused.kind) {
  case FUSED_NEGATION: append(builder, SERIES_NEGATION, result, series_coefficient(builder, fused.left), 0, 0); return;
  case FUSED_SUM:
  case FUSED_DIFFERENCE: append_sum(builder, node, fused); return;
  case FUSED_PRODUCT: append_product(builder, result, fused.left, fused.right); return;
  case FUSED_QUOTIENT: append_quotient(builder, node, fused.left, fused.right); return;
  case FUSED_POWER: append_power(builder, node, fused.left, fused.right); return;
  case FUSED_FUNCTION: append_function(builder, node); return;
  }
}
