#include "write/recurrences.h"

#include <assert.h>
#include <math.h>

bool is_constant_series(const struct SeriesWriter *writer, Node node) {
  return graph_is_constant_in_time(writer->emitter->graph, node);
}

/* What is constant in time has no row: its value is an operand, and its further coefficients are 0. */
static void write_name(const struct SeriesWriter *writer, Node node) {
  const struct Emitter *emitter = writer->emitter;
  FILE *file = emitter->file;
  assert(!is_constant_series(writer, node));
  if (writer->is_needed[node]) { /* without a row in the first text alone, which is thrown away */
    fprintf(file, "w[%zu]", writer->row[node] - 1);
    return;
  }
  const struct Symbol *symbol = graph_symbol_of(emitter->graph, node);
  if (symbol->kind == TIME) fputs("time", file);
  else if (symbol->kind == INPUT) fprintf(file, "input[%d]", symbol->index);
  else if (symbol->kind == COORDINATE) fprintf(file, "x[%d]", symbol->index);
  else if (symbol->kind == VELOCITY) fprintf(file, "x[%zu]", emitter->n + (size_t)symbol->index);
  else fprintf(file, "w[%zu]", writer->acceleration_row + (size_t)symbol->index);
}

void write_row(struct SeriesWriter *writer, Node node) {
  writer->is_array[node] = true;
  write_name(writer, node);
}

void write_coefficient(const struct SeriesWriter *writer, Node node) {
  FILE *file = writer->emitter->file;
  if (is_constant_series(writer, node)) fputs("0.0", file);
  else if (writer->is_needed[node] && writer->row[node] == 0) fprintf(file, "s%u", node);
  else {
    write_name(writer, node);
    fputs("[k]", file);
  }
}

/* name(k, rows...) with an optional further argument before the rows. */
static void write_recurrence(struct SeriesWriter *writer, const char *name, Node further, const Node *rows, int count) {
  FILE *file = writer->emitter->file;
  fprintf(file, "series_%s(k, ", name);
  if (further != ZERO) {
    statements_operand(writer->emitter->statements, further);
    fputs(", ", file);
  }
  for (int i = 0; i < count; i++) {
    fputs(i > 0 ? ", " : "", file);
    write_row(writer, rows[i]);
  }
  fputs(")", file);
  writer->recurrences++;
}

static void write_operand(const struct SeriesWriter *writer, Node node) {
  statements_operand(writer->emitter->statements, node);
}

static void write_product(struct SeriesWriter *writer, Node left, Node right) {
  FILE *file = writer->emitter->file;
  if (is_constant_series(writer, left) || is_constant_series(writer, right)) {
    Node factor = is_constant_series(writer, left) ? left : right;
    statements_operand(writer->emitter->statements, factor);
    fputs(" * ", file);
    write_coefficient(writer, factor == left ? right : left);
  } else write_recurrence(writer, "product", ZERO, (const Node[]){left, right}, 2);
}

/*
 * c' = factor a' / b for the inverse functions, where a_k stands first; sign is "-" or "", and the factor is constant in
 * time.
 */
static void write_ratio_integral(struct SeriesWriter *writer, const char *sign, Node factor, Node top, Node below,
                                 Node node) {
  FILE *file = writer->emitter->file;
  bool divides = is_constant_series(writer, below);
  fprintf(file, divides ? "%s" : "series_ratio_integral(k, %s", sign);
  if (factor != ONE) {
    fputs("(", file);
    write_operand(writer, factor);
    fputs(") * ", file);
  }
  write_coefficient(writer, top);
  fputs(divides ? " / " : ", ", file);
  if (divides) {
    write_operand(writer, below);
    return;
  }
  write_row(writer, below);
  fputs(", ", file);
  write_row(writer, node);
  fputs(")", file);
  writer->recurrences++;
}

/* top / below; the inverse of below's first coefficient has a place of its own. */
static void write_series_quotient(struct SeriesWriter *writer, Node top, Node below, Node node) {
  FILE *file = writer->emitter->file;
  if (writer->inverse[below] == 0) writer->inverse[below] = ++writer->row_count;
  fputs("series_quotient(k, ", file);
  write_coefficient(writer, top);
  fprintf(file, ", w[%zu][0], ", writer->inverse[below] - 1);
  write_row(writer, below);
  fputs(", ", file);
  write_row(writer, node);
  fputs(")", file);
  writer->recurrences++;
}

static void write_quotient(struct SeriesWriter *writer, Node left, Node right, Node node) {
  if (!is_constant_series(writer, right)) {
    write_series_quotient(writer, left, right, node);
    return;
  }
  write_coefficient(writer, left);
  fputs(" / ", writer->emitter->file);
  statements_operand(writer->emitter->statements, right);
}

static bool is_coordinate(const struct SeriesWriter *writer, Node node) {
  const struct Graph *graph = writer->emitter->graph;
  return graph->vertices[node].operation == SYMBOL && graph_symbol_of(graph, node)->kind == COORDINATE;
}

/* The row of the time derivative of an operand: that of a velocity, or one of the workspace. */
static void write_rate_row(struct SeriesWriter *writer, Node operand) {
  const struct Emitter *emitter = writer->emitter;
  if (is_coordinate(writer, operand))
    write_row(writer, emitter->program->model->velocities.items[graph_symbol_of(emitter->graph, operand)->index].node);
  else fprintf(emitter->file, "w[%zu]", writer->rate[operand] - 1);
}

void write_rate(struct SeriesWriter *writer, Node operand) {
  const struct Emitter *emitter = writer->emitter;
  if (is_coordinate(writer, operand) || writer->rate[operand] > 0) return;
  writer->rate[operand] = ++writer->row_count;
  fprintf(emitter->file, "  w[%zu][k - 1] = k * ", writer->rate[operand] - 1);
  write_coefficient(writer, operand);
  fputs(";\n", emitter->file);
}

/* y' = x' a */
static void write_integral(struct SeriesWriter *writer, const char *sign, Node operand, Node factor) {
  FILE *file = writer->emitter->file;
  if (is_constant_series(writer, operand)) fputs("0.0", file);
  else if (is_constant_series(writer, factor)) write_ratio_integral(writer, sign, factor, operand, ONE, operand);
  else {
    fprintf(file, "%sseries_integral(k, ", sign);
    write_rate_row(writer, operand);
    fputs(", ", file);
    write_row(writer, factor);
    fputs(")", file);
    writer->recurrences++;
  }
}

Node integrated_operand(const struct SeriesWriter *writer, Node node) {
  const struct Vertex *vertex = &writer->emitter->graph->vertices[node];
  switch (vertex->operation) {
  case SINE:
  case COSINE:
  case SINH:
  case COSH:
  case TANGENT:
  case TANH:
  case EXPONENTIAL: return vertex->left;
  case POWER: return is_constant_series(writer, vertex->right) ? ZERO : writer->plan->auxiliary[node];
  default: return ZERO;
  }
}

static void write_power(struct SeriesWriter *writer, Node base, Node exponent, Node node) {
  const struct Graph *graph = writer->emitter->graph;
  Node auxiliary = writer->plan->auxiliary[node];
  double n = graph_is_constant(graph, exponent) ? graph_value(graph, exponent) : NAN;
  if (n == 2.0) write_recurrence(writer, "square", ZERO, &base, 1);
  else if (n == -1.0) write_series_quotient(writer, ONE, base, node);
  else if (n == 0.5) write_recurrence(writer, "root", ZERO, (const Node[]){base, node}, 2);
  else if (!is_constant_series(writer, exponent)) write_integral(writer, "", auxiliary, node);
  else if (auxiliary == ZERO) write_recurrence(writer, "power", exponent, (const Node[]){base, node}, 2);
  else if (n < 0.0) write_series_quotient(writer, ONE, auxiliary, node);
  else if (graph_value(graph, graph->vertices[auxiliary].right) * 2.0 == n)
    write_recurrence(writer, "square", ZERO, &auxiliary, 1);
  else write_product(writer, auxiliary, base);
}

/*
 * c = atan2(y, x): (x^2 + y^2) c' = y' x - x' y. Any of y, x and x^2 + y^2 may be constant, the last one as the square of
 * a rod's length.
 */
static void write_angle(struct SeriesWriter *writer, Node y, Node x, Node square, Node node) {
  if (is_constant_series(writer, x)) write_ratio_integral(writer, "", x, y, square, node);
  else if (is_constant_series(writer, y)) write_ratio_integral(writer, "-", y, x, square, node);
  else if (is_constant_series(writer, square)) {
    write_recurrence(writer, "area", ZERO, (const Node[]){y, x}, 2);
    fputs(" / ", writer->emitter->file);
    write_operand(writer, square);
  } else write_recurrence(writer, "angle", ZERO, (const Node[]){y, x, square, node}, 4);
}

/* The coefficients of the piece that is there first: that of the larger or of the smaller operand. */
static void write_choice(struct SeriesWriter *writer, enum Operation operation, Node left, Node right,
                         Node difference) {
  FILE *file = writer->emitter->file;
  fputs("(", file);
  if (is_constant_series(writer, difference)) write_operand(writer, difference);
  else write_recurrence(writer, "sign", ZERO, &difference, 1);
  fputs(operation == MAXIMUM ? " > 0.0) ? " : " < 0.0) ? ", file);
  write_coefficient(writer, left);
  fputs(" : ", file);
  write_coefficient(writer, right);
}

static void write_function(struct SeriesWriter *writer, Node node) {
  const struct Vertex *vertex = &writer->emitter->graph->vertices[node];
  Node operand = vertex->left, auxiliary = writer->plan->auxiliary[node];
  switch (vertex->operation) {
  case COSINE: write_integral(writer, "-", operand, auxiliary); return;
  case SINE:
  case SINH:
  case COSH:
  case TANGENT:
  case TANH: write_integral(writer, "", operand, auxiliary); return;
  case EXPONENTIAL: write_integral(writer, "", operand, node); return;
  case LOGARITHM: write_ratio_integral(writer, "", ONE, operand, operand, node); return;
  case ARCCOSINE: write_ratio_integral(writer, "-", ONE, operand, auxiliary, node); return;
  case MINIMUM:
  case MAXIMUM: write_choice(writer, vertex->operation, operand, vertex->right, auxiliary); return;
  case SIGN:
  case LESS: fputs("0.0", writer->emitter->file); return;
  case ABSOLUTE:
    write_recurrence(writer, "sign", ZERO, &operand, 1);
    fputs(" * ", writer->emitter->file);
    write_coefficient(writer, operand);
    return;
  case ATAN2: write_angle(writer, operand, vertex->right, auxiliary, node); return;
  default: write_ratio_integral(writer, "", ONE, operand, auxiliary, node);
  }
}

void write_value(struct SeriesWriter *writer, Node node) {
  struct Expression expression = expression_of(writer->emitter->statements, node, writer->uses);
  FILE *file = writer->emitter->file;
  Node left = expression.left, right = expression.right;
  switch (expression.form) {
  case FORM_NEGATION:
    fputs("-", file);
    write_coefficient(writer, left);
    return;
  case FORM_SUM:
  case FORM_DIFFERENCE:
    if (!is_constant_series(writer, left)) write_coefficient(writer, left);
    if (expression.form == FORM_DIFFERENCE) fputs(is_constant_series(writer, left) ? "-" : " - ", file);
    else if (!is_constant_series(writer, left) && !is_constant_series(writer, right)) fputs(" + ", file);
    if (!is_constant_series(writer, right)) write_coefficient(writer, right);
    else if (expression.form == FORM_DIFFERENCE) fputs("0.0", file);
    return;
  case FORM_PRODUCT: write_product(writer, left, right); return;
  case FORM_QUOTIENT: write_quotient(writer, left, right, node); return;
  case FORM_POWER: write_power(writer, left, right, node); return;
  case FORM_FUNCTION: write_function(writer, node); return;
  }
}
