#include "write/emit_limit.h"

#include <math.h>
#include <stdlib.h>

#include "memory.h"
#include "series_limit.h"
#include "algebra/simplify.h"

/* What limits the step by a node: a function of series_limit.h, and what it is called with. */
struct Check {
  const char *limit;    /* the rest of the name after series_limit_ */
  Node rows[2];         /* ZERO for none */
  const char *function; /* the name for messages, where the limit takes one */
  Node exponent;        /* known at run time alone; ZERO for none */
  double share;         /* for powers with a number as exponent, else NAN */
};

struct CheckList {
  struct Check *items;
  size_t count;
};

/* One check serves all powers of a base; of two, the one with the smaller share shortens more. */
static void append(struct CheckList *list, struct Check check) {
  for (size_t i = 0; i < list->count; i++) {
    struct Check *other = &list->items[i];
    if (other->limit != check.limit || other->rows[0] != check.rows[0] || other->rows[1] != check.rows[1] ||
        other->exponent != check.exponent)
      continue;
    if (check.share < other->share) other->share = check.share;
    return;
  }
  list->items = reallocate(list->items, list->count + 1, sizeof *list->items);
  list->items[list->count++] = check;
}

static bool has_row(const struct SeriesWriter *writer, Node node) {
  return !is_constant_series(writer, node) &&
         (writer->is_needed[node] || writer->emitter->graph->vertices[node].operation == SYMBOL);
}

/* base^exponent with constant factors and inner powers of the base taken off, as they do not matter here. */
static Node bare_base(const struct SeriesWriter *writer, Node base, double *exponent) {
  const struct Graph *graph = writer->emitter->graph;
  for (;;) {
    const struct Vertex *vertex = &graph->vertices[base];
    Node inner = base;
    double factor = 1.0;
    if (vertex->operation == MULTIPLY && is_constant_series(writer, vertex->left)) inner = vertex->right;
    else if (vertex->operation == MULTIPLY && is_constant_series(writer, vertex->right)) inner = vertex->left;
    else if (vertex->operation == POWER && graph_is_constant(graph, vertex->right)) {
      inner = vertex->left;
      factor = graph_value(graph, vertex->right);
    }
    if (inner == base || !has_row(writer, inner)) return base;
    base = inner;
    *exponent *= factor;
  }
}

static const char *const quotient = "quotient", *const division = "division", *const root = "root",
                         *const whole_power = "whole_power", *const power_at_run_time = "power",
                         *const exponential = "exponential", *const positive = "positive",
                         *const hyperbolic = "hyperbolic", *const sign = "sign";

/* The numerator is known to be 0 for some motions through a point where the denominator vanishes. */
static void check_division(const struct SeriesWriter *writer, struct CheckList *list, Node numerator,
                           Node denominator) {
  double exponent = -1.0;
  Node base = bare_base(writer, denominator, &exponent);
  struct Check check = {.limit = quotient, .rows = {base}, .share = series_limit_share(exponent)};
  if (has_row(writer, numerator)) {
    check.limit = division;
    check.rows[1] = numerator;
  }
  append(list, check);
}

static void check_number_power(const struct SeriesWriter *writer, struct CheckList *list, Node base, double exponent) {
  base = bare_base(writer, base, &exponent);
  bool is_whole = exponent == floor(exponent);
  if (is_whole && exponent > 0.0 && exponent <= 3.0) return;
  const char *limit = exponent < 0.0 ? quotient : is_whole ? whole_power : root;
  append(list, (struct Check){.limit = limit, .rows = {base}, .share = series_limit_share(exponent)});
}

static void check_power(const struct SeriesWriter *writer, struct CheckList *list, Node node) {
  const struct Graph *graph = writer->emitter->graph;
  const struct Vertex *vertex = &graph->vertices[node];
  Node auxiliary = writer->plan->auxiliary[node];
  if (graph_is_constant(graph, vertex->right))
    check_number_power(writer, list, vertex->left, graph_value(graph, vertex->right));
  else if (is_constant_series(writer, vertex->right))
    append(list,
           (struct Check){.limit = power_at_run_time, .rows = {vertex->left}, .exponent = vertex->right, .share = NAN});
  else if (has_row(writer, auxiliary))
    append(list, (struct Check){.limit = exponential, .rows = {auxiliary}, .function = "pow", .share = NAN});
}

static void check_function(const struct SeriesWriter *writer, struct CheckList *list, Node node) {
  const struct Vertex *vertex = &writer->emitter->graph->vertices[node];
  const char *name = operation_name(vertex->operation);
  Node auxiliary = writer->plan->auxiliary[node];
  struct Check check = {.rows = {vertex->left}, .function = name, .share = NAN};
  switch (vertex->operation) {
  case EXPONENTIAL: check.limit = exponential; break;
  case SINH:
  case COSH: check.limit = hyperbolic; break;
  case LOGARITHM: check.limit = positive; break;
  case ARCTANGENT:
  case ARTANH:
    check.limit = positive;
    check.rows[0] = auxiliary;
    break;
  case ABSOLUTE:
  case SIGN: check.limit = sign; break;
  case MINIMUM:
  case MAXIMUM:
  case LESS:
    check.limit = sign;
    check.rows[0] = auxiliary;
    break;
  case TANH:
    check.limit = "tanh";
    check.function = NULL;
    break;
  case TANGENT:
    check.limit = "tangent";
    check.function = NULL;
    break;
  case ATAN2:
    if (has_row(writer, auxiliary))
      append(list, (struct Check){.limit = positive, .rows = {auxiliary}, .function = name, .share = NAN});
    if (!has_row(writer, vertex->left) || !has_row(writer, vertex->right)) return;
    check = (struct Check){.limit = "angle", .rows = {vertex->left, vertex->right}, .share = NAN};
    break;
  default: return;
  }
  if (has_row(writer, check.rows[0])) append(list, check);
}

/* Where a power of the denominator itself is checked, its numerators do not matter. */
static void drop_covered(struct CheckList *list) {
  size_t count = 0;
  for (size_t i = 0; i < list->count; i++) {
    const struct Check check = list->items[i];
    bool covered = false;
    for (size_t j = 0; j < list->count && check.limit == division; j++)
      covered |= list->items[j].limit == quotient && list->items[j].rows[0] == check.rows[0] &&
                 list->items[j].share <= check.share;
    if (!covered) list->items[count++] = check;
  }
  list->count = count;
}

static struct CheckList find_checks(const struct SeriesWriter *writer) {
  struct CheckList list = {0};
  for (size_t i = 0; i < writer->node_count; i++) {
    struct Expression expression = expression_of(writer->emitter->statements, writer->nodes[i], writer->uses);
    if (expression.form == FORM_POWER) check_power(writer, &list, writer->nodes[i]);
    else if (expression.form == FORM_FUNCTION) check_function(writer, &list, writer->nodes[i]);
    else if (expression.form == FORM_QUOTIENT && has_row(writer, expression.right))
      check_division(writer, &list, expression.left, expression.right);
  }
  drop_covered(&list);
  return list;
}

size_t limit_mark_rows(struct SeriesWriter *writer) {
  struct CheckList list = find_checks(writer);
  for (size_t i = 0; i < list.count; i++)
    for (int j = 0; j < 2; j++)
      if (list.items[i].rows[j] != ZERO) writer->is_array[list.items[i].rows[j]] = true;
  free(list.items);
  return list.count;
}

static void write_check(struct SeriesWriter *writer, const struct Check *check) {
  FILE *file = writer->emitter->file;
  fprintf(file, "  series_limit_%s(limit", check->limit);
  for (int j = 0; j < 2 && check->rows[j] != ZERO; j++) {
    fputs(", ", file);
    write_row(writer, check->rows[j]);
  }
  if (check->function != NULL) fprintf(file, ", \"%s\"", check->function);
  if (check->exponent != ZERO || !isnan(check->share)) fputs(", ", file);
  if (check->exponent != ZERO) statements_operand(writer->emitter->statements, check->exponent);
  else if (!isnan(check->share)) write_c_number(file, check->share);
  fputs(");\n", file);
}

static void limit_body(struct Emitter *emitter, size_t unused) {
  struct SeriesWriter *writer = emitter->series;
  (void)unused;
  struct CheckList list = find_checks(writer);
  bool uses_time = false;
  for (size_t i = 0; i < list.count; i++)
    for (int j = 0; j < 2; j++)
      uses_time |= emitter->graph->vertices[list.items[i].rows[j]].operation == SYMBOL &&
                   graph_symbol_of(emitter->graph, list.items[i].rows[j])->kind == TIME;
  if (uses_time) fputs("  const Series time = {point->time, 1.0};\n", emitter->file);
  for (size_t i = 0; i < list.count; i++) write_check(writer, &list.items[i]);
  free(list.items);
}

void emit_limit(struct Emitter *emitter, struct SeriesWriter *writer) {
  emitter->series = writer;
  emit_function(emitter, "Shortens a step to where the series hide nothing",
                "void limit(const struct Point *point, const Series *restrict input, const Series *restrict x, "
                "const Series *restrict w, struct SeriesLimit *limit)",
                limit_body, 0);
}
