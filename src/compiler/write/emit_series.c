#include "write/emit_series.h"

#include <stdlib.h>
#include <string.h>

#include "write/emit_accelerations.h"
#include "write/emit_limit.h"
#include "memory.h"

/*
 * Systems up to this many recurrences an order get code of their own for the first orders, as many as have together so
 * many products that their code stays in the processor's instruction cache.
 */
enum { UNROLLED_RECURRENCES = 40, UNROLLED_PRODUCTS = 1300 };

/* Whether it is a power with an exponent that varies, whose coefficients rest on its auxiliary node alone. */
static bool integrated_power(const struct SeriesWriter *writer, Node node) {
  return writer->emitter->graph->vertices[node].operation == POWER && integrated_operand(writer, node) != ZERO;
}

/* The nodes that change in time and are computed. */
static void find_needed(struct SeriesWriter *writer) {
  const struct Statements *statements = writer->emitter->statements;
  const struct SeriesPlan *plan = writer->plan;
  size_t size = writer->emitter->graph->count;
  bool *below = allocate(size, sizeof *below);
  for (size_t i = 0; i < plan->count; i++) below[plan->targets[i]] = true;
  for (Node node = (Node)size; node-- > 0;) {
    if (!below[node] || is_fetched(statements, node)) continue;
    writer->is_needed[node] = true;
    if (integrated_power(writer, node)) continue;
    struct Expression expression = expression_of(statements, node, writer->uses);
    below[expression.left] = true;
    if (expression.arity == 2) below[expression.right] = true;
  }
  for (Node node = 0; node < size; node++)
    if (writer->is_needed[node]) writer->nodes[writer->node_count++] = node;
  free(below);
}

/* Rows of workspace for the lower triangle of a block's factors. */
static size_t block_factor_rows(const struct Equations *equations, size_t block) {
  size_t size = 0;
  for (size_t i = 0; i < equations->count; i++) size += equations->block[i] == block;
  return (size * (size + 1) / 2 + SERIES_LENGTH - 1) / SERIES_LENGTH;
}

/* Rows for the nodes that are arrays, then, where asked for, for the accelerations themselves. */
static void assign_rows(struct SeriesWriter *writer) {
  writer->row_count = 0;
  for (size_t i = 0; i < writer->node_count; i++)
    writer->row[writer->nodes[i]] = writer->is_array[writer->nodes[i]] ? ++writer->row_count : 0;
  writer->acceleration_row = writer->row_count;
  if (writer->has_acceleration_rows) writer->row_count += writer->emitter->n;
  writer->factor_row = writer->row_count;
  const struct Equations *equations = writer->emitter->equations;
  for (size_t block = 0; writer->keeps_factors && block < equations->block_count; block++)
    if (block_is_looped(equations, block)) writer->row_count += block_factor_rows(equations, block);
}

static void write_next(struct SeriesWriter *writer, Node node);

/* Auxiliary nodes may be younger than those that need them, so that numeric order alone does not do. */
static void write_needed(struct SeriesWriter *writer, Node node) {
  const struct Graph *graph = writer->emitter->graph;
  struct Expression expression = expression_of(writer->emitter->statements, node, writer->uses);
  if (!integrated_power(writer, node)) {
    write_next(writer, expression.left);
    if (expression.arity == 2) write_next(writer, expression.right);
  }
  enum Operation operation = graph->vertices[node].operation;
  if (operation == POWER || operation == MINIMUM || operation == MAXIMUM)
    write_next(writer, writer->plan->auxiliary[node]);
}

static void write_next(struct SeriesWriter *writer, Node node) {
  FILE *file = writer->emitter->file;
  if (!writer->is_needed[node] || writer->done[node]) return;
  writer->done[node] = true;
  write_needed(writer, node);
  Node operand = integrated_operand(writer, node);
  if (operand != ZERO) write_rate(writer, operand);
  fputs(writer->row[node] == 0 ? "  const double " : "  ", file);
  write_coefficient(writer, node);
  fputs(" = ", file);
  write_value(writer, node);
  fputs(";\n", file);
  /* The sine and the cosine of one argument need each other, one coefficient behind. */
  enum Operation operation = writer->emitter->graph->vertices[node].operation;
  if (operation == SINE || operation == COSINE || operation == SINH || operation == COSH)
    write_next(writer, writer->plan->auxiliary[node]);
}

/* M_0 a_k = b_k - sum over l of M_l a_(k-l) in each large block. */
static void write_block_order(struct SeriesWriter *writer, size_t block) {
  struct Emitter *emitter = writer->emitter;
  const struct Equations *equations = emitter->equations;
  size_t n = emitter->n, count = 0, *place = allocate(n, sizeof *place);
  for (size_t i = 0; i < n; i++)
    if (equations->block[i] == block) place[i] = count++;
  fprintf(emitter->file, "    double y%zu[%zu];\n", block, count);
  for (size_t i = 0; i < n; i++) {
    if (equations->block[i] != block) continue;
    fprintf(emitter->file, "    y%zu[%zu] = ", block, place[i]);
    write_coefficient(writer, equations->right_side[i]);
    for (size_t j = 0; j < n; j++) {
      Node mass = equations->mass[(i > j ? i : j) * n + (i > j ? j : i)];
      if (equations->block[j] != block || is_constant_series(writer, mass)) continue;
      fputs(" - series_rest(k, ", emitter->file);
      write_row(writer, mass);
      fprintf(emitter->file, ", w[%zu])", writer->acceleration_row + j);
      writer->recurrences++;
    }
    fputs(";\n", emitter->file);
  }
  fprintf(emitter->file, "    ldlt_solve(%zu, mass%zu, y%zu);\n", count, block, block);
  for (size_t i = 0; i < n; i++)
    if (equations->block[i] == block)
      fprintf(emitter->file, "    w[%zu][k] = y%zu[%zu];\n", writer->acceleration_row + i, block, place[i]);
  free(place);
}

/* The coefficient k + 1 of the state from coefficient k of its derivative. */
static void write_state_order(struct SeriesWriter *writer) {
  struct Emitter *emitter = writer->emitter;
  const struct Equations *equations = emitter->equations;
  size_t n = emitter->n;
  for (size_t i = 0; i < n; i++) {
    fprintf(emitter->file, "    x[%zu][k + 1] = x[%zu][k] * (1.0 / (k + 1));\n    x[%zu][k + 1] = ", i, n + i, n + i);
    write_coefficient(writer, equations->acceleration[i]);
    fputs(" * (1.0 / (k + 1));\n", emitter->file);
  }
  if (emitter->states == 2 * n) return;
  fprintf(emitter->file, "    x[%zu][k + 1] = ", 2 * n);
  write_coefficient(writer, equations->power);
  fputs(" * (1.0 / (k + 1));\n", emitter->file);
}

static void write_order(struct SeriesWriter *writer) {
  const struct Equations *equations = writer->emitter->equations;
  for (size_t i = 0; i < writer->node_count; i++) write_next(writer, writer->nodes[i]);
  for (size_t block = 0; block < equations->block_count; block++)
    if (block_is_looped(equations, block)) write_block_order(writer, block);
  write_state_order(writer);
}

/* The text of one order. */
static char *write_text(struct SeriesWriter *writer, void (*write)(struct SeriesWriter *)) {
  FILE *file = writer->emitter->file;
  char *text = NULL;
  size_t length = 0, size = writer->emitter->graph->count;
  memset(writer->done, 0, size * sizeof *writer->done);
  memset(writer->rate, 0, size * sizeof *writer->rate);
  memset(writer->inverse, 0, size * sizeof *writer->inverse);
  writer->recurrences = 0;
  assign_rows(writer);
  writer->emitter->file = writer->emitter->statements->file = open_text(&text, &length);
  write(writer);
  fclose(writer->emitter->file);
  writer->emitter->file = writer->emitter->statements->file = file;
  return text;
}

/* The first text tells which nodes are arrays; the others become local variables of the second. */
static char *order_text(struct SeriesWriter *writer, void (*write)(struct SeriesWriter *)) {
  free(write_text(writer, write));
  return write_text(writer, write);
}

/* What series_next() may need beside k, x and w: its type, its name, and what series() passes for it. */
static const struct {
  const char *use, *declaration, *argument;
} further_arguments[] = {
    {"p[", "const double *p", "point->parameter"},
    {"c[", "const double *c", "point->prepared"},
    {"time", "const double *time", "time"},
    {"input[", "const Series *restrict input", "input"},
};

/* The declarations or the arguments that the text of an order uses. */
static void write_further(const struct SeriesWriter *writer, bool declare) {
  for (size_t i = 0; i < sizeof further_arguments / sizeof *further_arguments; i++)
    if (strstr(writer->order_text, further_arguments[i].use) != NULL)
      fprintf(writer->emitter->file, "%s, ",
              declare ? further_arguments[i].declaration : further_arguments[i].argument);
}

static void write_next_function(const struct SeriesWriter *writer) {
  FILE *file = writer->emitter->file;
  fprintf(file, "/* Coefficient k of all series, k + 1 of the state; %zu recurrences */\n", writer->recurrences);
  fputs("static SERIES_INLINE void series_next(int k, ", file);
  write_further(writer, true);
  fprintf(file, "Series *restrict x, Series *restrict w) {\n%s}\n\n", writer->order_text);
}

static void write_next_call(const struct SeriesWriter *writer, const char *order) {
  fprintf(writer->emitter->file, "series_next(%s, ", order);
  write_further(writer, false);
  fputs("x, w); break;\n", writer->emitter->file);
}

/* The orders from 1 on; in small systems the first are calls with a constant order, which the compiler unrolls. */
static void write_orders(const struct SeriesWriter *writer) {
  FILE *file = writer->emitter->file;
  if (!writer->is_unrolled) {
    fprintf(file, "  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) {\n%s  }\n", writer->order_text);
    return;
  }
  fputs("  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) {\n    switch (k) {\n", file);
  size_t products = 0;
  for (size_t k = 1; k + 1 < SERIES_LENGTH; k++) {
    products += k * writer->recurrences;
    if (products > UNROLLED_PRODUCTS) break;
    char *order = format_text("%zu", k);
    fprintf(file, "    case %zu: ", k);
    write_next_call(writer, order);
    free(order);
  }
  fputs("    default: ", file);
  write_next_call(writer, "k");
  fputs("    }\n  }\n", file);
}

static void write_inverses(const struct SeriesWriter *writer) {
  const struct Emitter *emitter = writer->emitter;
  for (Node node = 0; node < emitter->graph->count; node++) {
    if (writer->inverse[node] == 0) continue;
    fprintf(emitter->file, "  w[%zu][0] = 1.0 / ", writer->inverse[node] - 1);
    statements_operand(emitter->statements, node);
    fputs(";\n", emitter->file);
  }
}

/* Coefficient 0 of all rows. */
static void write_first(struct SeriesWriter *writer) {
  struct Emitter *emitter = writer->emitter;
  for (size_t i = 0; i < writer->node_count; i++) {
    Node node = writer->nodes[i];
    if (writer->row[node] == 0) continue;
    fprintf(emitter->file, "  w[%zu][0] = ", writer->row[node] - 1);
    statements_operand(emitter->statements, node);
    fputs(";\n", emitter->file);
  }
  write_inverses(writer);
}

/* The statements for coefficient 0 of the rows, and for the values of further nodes. */
static void write_values(const struct SeriesWriter *writer, struct NodeList further) {
  struct NodeList list = {0};
  append_nodes(&list, further.nodes, further.count);
  for (size_t i = 0; i < writer->node_count; i++)
    if (writer->row[writer->nodes[i]] > 0) append_nodes(&list, &writer->nodes[i], 1);
  statements_emit(writer->emitter->statements, list.nodes, list.count);
  free(list.nodes);
}

static void declare_time(const struct SeriesWriter *writer) {
  if (strstr(writer->order_text, "time") != NULL)
    fputs("  const Series time = {point->time, 1.0};\n", writer->emitter->file);
}

/* Blocks that are factored at run time hand their factors from start() to series() in rows of the workspace. */
static void write_block_factors(const struct SeriesWriter *writer, bool keep) {
  const struct Equations *equations = writer->emitter->equations;
  size_t row = writer->factor_row;
  for (size_t block = 0; block < equations->block_count; block++) {
    if (!block_is_looped(equations, block)) continue;
    if (keep) fprintf(writer->emitter->file, "  memcpy(w[%zu], mass%zu, sizeof mass%zu);\n", row, block, block);
    else fprintf(writer->emitter->file, "  const double *mass%zu = w[%zu];\n", block, row);
    row += block_factor_rows(equations, block);
  }
}

/* d state / dt and coefficient 0 of all series. */
static void start_body(struct Emitter *emitter, size_t unused) {
  struct SeriesWriter *writer = emitter->series;
  (void)unused;
  size_t n = emitter->n;
  fprintf(emitter->file, "  double *a = derivative + %zu;\n", n);
  Node power = emitter->equations->power;
  write_values(writer, (struct NodeList){&power, emitter->states > 2 * n});
  emit_accelerations(emitter, "a");
  write_first(writer);
  for (size_t i = 0; i < n; i++) {
    emit_assignment(emitter, "derivative", i, emitter->program->model->velocities.items[i].node);
    if (is_looped(emitter->equations, i))
      fprintf(emitter->file, "  w[%zu][0] = a[%zu];\n", writer->acceleration_row + i, i);
  }
  write_block_factors(writer, true);
  if (emitter->states > 2 * n) emit_assignment(emitter, "derivative", 2 * n, power);
  fputs("  return 0;\n", emitter->file);
}

static void series_body(struct Emitter *emitter, size_t unused) {
  struct SeriesWriter *writer = emitter->series;
  (void)unused;
  declare_time(writer);
  write_block_factors(writer, false);
  write_orders(writer);
}

static struct SeriesWriter *writer_create(struct Emitter *emitter, const struct SeriesPlan *plan) {
  size_t size = emitter->graph->count;
  struct SeriesWriter *writer = allocate(1, sizeof *writer);
  *writer = (struct SeriesWriter){.emitter = emitter,
                                  .plan = plan,
                                  .uses = count_uses(emitter->statements, plan->targets, plan->count),
                                  .row = allocate(size, sizeof(size_t)),
                                  .is_needed = allocate(size, sizeof(bool)),
                                  .is_array = allocate(size, sizeof(bool)),
                                  .rate = allocate(size, sizeof(size_t)),
                                  .inverse = allocate(size, sizeof(size_t)),
                                  .done = allocate(size, sizeof(bool)),
                                  .nodes = allocate(size, sizeof(Node))};
  find_needed(writer);
  return writer;
}

void series_writer_free(struct SeriesWriter *writer) {
  free(writer->order_text);
  free(writer->uses);
  free(writer->row);
  free(writer->is_needed);
  free(writer->is_array);
  free(writer->rate);
  free(writer->inverse);
  free(writer->done);
  free(writer->nodes);
  free(writer);
}

struct SeriesWriter *series_writer_create(struct Emitter *emitter) {
  struct SeriesWriter *writer = writer_create(emitter, emitter->program->series);
  writer->has_acceleration_rows = writer->keeps_factors = has_loops(emitter->equations);
  emitter->has_limit = limit_mark_rows(writer) > 0;
  writer->order_text = order_text(writer, write_order);
  writer->is_unrolled = emitter->program->interface->method->series == ALL_TERMS && !has_loops(emitter->equations) &&
                        writer->recurrences <= UNROLLED_RECURRENCES;
  return writer;
}

size_t emit_series(struct Emitter *emitter, struct SeriesWriter *writer) {
  size_t rows = writer->row_count;
  if (writer->is_unrolled) write_next_function(writer);
  emitter->series = writer;
  emit_function(emitter, "d state / dt, and the first coefficients of all series",
                "int start(const struct Point *point, double *derivative, Series *restrict w)", start_body, 0);
  emit_function(emitter, "Taylor coefficients of the state up to the order",
                "void series(const struct Point *point, int order, const Series *restrict input, Series *restrict x, "
                "Series *restrict w)",
                series_body, 0);
  if (emitter->has_limit) emit_limit(emitter, writer);
  series_writer_free(writer);
  return rows;
}

/* Coefficient k of all rows and of the outputs; the accelerations are the derivatives of the velocities. */
static void write_output_order(struct SeriesWriter *writer) {
  const struct Emitter *emitter = writer->emitter;
  size_t n = emitter->n;
  for (size_t i = 0; writer->has_acceleration_rows && i < n; i++)
    fprintf(emitter->file, "    w[%zu][k] = (k + 1) * x[%zu][k + 1];\n", writer->acceleration_row + i, n + i);
  for (size_t i = 0; i < writer->node_count; i++) write_next(writer, writer->nodes[i]);
  const struct VariableList *outputs = &emitter->program->model->outputs;
  for (size_t i = 0; i < outputs->count; i++) {
    fprintf(emitter->file, "    y[%zu][k] = ", i);
    write_coefficient(writer, outputs->items[i].node);
    fputs(";\n", emitter->file);
  }
}

static void output_series_body(struct Emitter *emitter, size_t unused) {
  struct SeriesWriter *writer = emitter->series;
  (void)unused;
  declare_time(writer);
  if (writer->has_acceleration_rows) {
    fprintf(emitter->file, "  double a[%zu];\n", emitter->n);
    for (size_t i = 0; i < emitter->n; i++)
      fprintf(emitter->file, "  a[%zu] = w[%zu][0] = x[%zu][1];\n", i, writer->acceleration_row + i, emitter->n + i);
  }
  struct NodeList outputs = {0};
  for (size_t i = 0; i < emitter->program->model->outputs.count; i++)
    append_nodes(&outputs, &emitter->program->model->outputs.items[i].node, 1);
  write_values(writer, outputs);
  free(outputs.nodes);
  write_first(writer);
  for (size_t i = 0; i < emitter->program->model->outputs.count; i++) {
    fprintf(emitter->file, "  y[%zu][0] = ", i);
    statements_operand(emitter->statements, emitter->program->model->outputs.items[i].node);
    fputs(";\n", emitter->file);
  }
  fprintf(emitter->file, "  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++) {\n%s  }\n", writer->order_text);
}

size_t emit_output_series(struct Emitter *emitter) {
  struct SeriesWriter *writer = writer_create(emitter, emitter->program->output_series);
  writer->has_acceleration_rows = uses_accelerations(emitter->graph, writer->plan->targets, writer->plan->count);
  writer->order_text = order_text(writer, write_output_order);
  size_t rows = writer->row_count;
  emitter->series = writer;
  emit_function(emitter, "Taylor coefficients of the outputs up to the order",
                "void output_series(const struct Point *point, int order, const Series *restrict input, "
                "const Series *restrict x, Series *restrict w, Series *restrict y)",
                output_series_body, 0);
  series_writer_free(writer);
  return rows;
}
