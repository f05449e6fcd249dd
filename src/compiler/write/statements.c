#include "write/statements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "algebra/formula.h"
#include "algebra/simplify.h"

struct Statements *statements_create(const struct Graph *graph) {
  struct Statements *statements = allocate(1, sizeof *statements);
  statements->graph = graph;
  statements->slot = allocate(graph->count, sizeof *statements->slot);
  statements->number = allocate(graph->count, sizeof *statements->number);
  return statements;
}

void statements_free(struct Statements *statements) {
  if (statements == NULL) return;
  free(statements->slot);
  free(statements->prepared);
  free(statements->number);
  free(statements);
}

static bool is_leaf(const struct Graph *graph, Node node) {
  return operation_arity(graph->vertices[node].operation) == 0;
}

static bool is_of_parameters(const struct Graph *graph, Node node) {
  return !is_leaf(graph, node) && graph_is_constant_in_time(graph, node);
}

bool is_fetched(const struct Statements *statements, Node node) {
  return is_leaf(statements->graph, node) || (!statements->preparing && is_of_parameters(statements->graph, node));
}

void statements_announce(struct Statements *statements, const Node *targets, size_t count) {
  const struct Graph *graph = statements->graph;
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, targets, count, needed);
  for (size_t i = 0; i < count; i++)
    if (is_of_parameters(graph, targets[i])) statements->slot[targets[i]] = 1;
  for (Node node = 0; node < graph->count; node++) {
    if (!needed[node] || is_leaf(graph, node) || is_of_parameters(graph, node)) continue;
    const struct Vertex *vertex = &graph->vertices[node];
    if (is_of_parameters(graph, vertex->left)) statements->slot[vertex->left] = 1;
    if (operation_arity(vertex->operation) == 2 && is_of_parameters(graph, vertex->right))
      statements->slot[vertex->right] = 1;
  }
  free(needed);
}

void statements_settle(struct Statements *statements) {
  for (Node node = 0; node < statements->graph->count; node++) {
    if (statements->slot[node] == 0) continue;
    statements->prepared =
        reallocate(statements->prepared, statements->prepared_count + 1, sizeof *statements->prepared);
    statements->prepared[statements->prepared_count++] = node;
    statements->slot[node] = statements->prepared_count;
  }
}

void statements_begin(struct Statements *statements, FILE *file) {
  statements->file = file;
  memset(statements->number, 0, statements->graph->count * sizeof *statements->number);
  statements->local_count = statements->operation_count = 0;
}

static bool is_power(const struct Statements *statements, Node node, double exponent) {
  const struct Vertex *vertex = &statements->graph->vertices[node];
  return !is_fetched(statements, node) && vertex->operation == POWER &&
         graph_is_constant(statements->graph, vertex->right) &&
         graph_value(statements->graph, vertex->right) == exponent;
}

static bool is_negation(const struct Statements *statements, Node node) {
  Node base;
  return !is_fetched(statements, node) && coefficient_of(statements->graph, node, &base) == -1.0;
}

struct Expression expression_of(const struct Statements *statements, Node node, const size_t *uses) {
  const struct Vertex *vertex = &statements->graph->vertices[node];
  const struct Vertex *vertices = statements->graph->vertices;
  Node left = vertex->left, right = vertex->right;
  switch (vertex->operation) {
  case ADD:
    if (is_negation(statements, right)) return (struct Expression){FORM_DIFFERENCE, left, vertices[right].right, 2};
    if (is_negation(statements, left)) return (struct Expression){FORM_DIFFERENCE, right, vertices[left].right, 2};
    return (struct Expression){FORM_SUM, left, right, 2};
  case MULTIPLY:
    if (is_negation(statements, node)) return (struct Expression){FORM_NEGATION, right, ZERO, 1};
    if (is_power(statements, right, -1.0) && uses[right] == 1)
      return (struct Expression){FORM_QUOTIENT, left, vertices[right].left, 2};
    if (is_power(statements, left, -1.0) && uses[left] == 1)
      return (struct Expression){FORM_QUOTIENT, right, vertices[left].left, 2};
    return (struct Expression){FORM_PRODUCT, left, right, 2};
  case POWER: return (struct Expression){FORM_POWER, left, right, 2};
  default: return (struct Expression){FORM_FUNCTION, left, right, operation_arity(vertex->operation)};
  }
}

size_t *count_uses(const struct Statements *statements, const Node *targets, size_t count) {
  const struct Graph *graph = statements->graph;
  bool *needed = allocate(graph->count, sizeof *needed);
  size_t *uses = allocate(graph->count, sizeof *uses);
  graph_mark(graph, targets, count, needed);
  for (size_t i = 0; i < count; i++) uses[targets[i]] += 2; /* a target is written by itself */
  for (Node node = 0; node < graph->count; node++) {
    if (!needed[node] || is_fetched(statements, node)) continue;
    const struct Vertex *vertex = &graph->vertices[node];
    uses[vertex->left]++;
    if (operation_arity(vertex->operation) == 2) uses[vertex->right]++;
  }
  free(needed);
  return uses;
}

void write_c_number(FILE *file, double value) {
  if (isnan(value)) fputs("NAN", file);
  else if (isinf(value)) fputs(value > 0 ? "INFINITY" : "-INFINITY", file);
  else {
    print_number(file, value);
    if (value == floor(value) && fabs(value) < 1e15) fputs(".0", file);
  }
}

static void write_symbol(FILE *file, const struct Symbol *symbol) {
  static const char *const arrays[] = {
      [PARAMETER] = "p",        [COORDINATE] = "q",     [VELOCITY] = "v",
      [ACCELERATION] = "a",     [INPUT] = "u",          [SEED_PARAMETER] = "dp",
      [SEED_COORDINATE] = "dq", [SEED_VELOCITY] = "dv", [SEED_ACCELERATION] = "da",
      [SEED_INPUT] = "du",
  };
  if (symbol->kind == TIME) fputs("point->time", file);
  else if (symbol->kind == SEED_TIME) fputs("seed->time", file);
  else fprintf(file, "%s[%d]", arrays[symbol->kind], symbol->index);
}

void statements_operand(const struct Statements *statements, Node node) {
  const struct Graph *graph = statements->graph;
  if (graph_is_constant(graph, node)) write_c_number(statements->file, graph_value(graph, node));
  else if (graph->vertices[node].operation == SYMBOL) write_symbol(statements->file, graph_symbol_of(graph, node));
  else if (!statements->preparing && is_of_parameters(graph, node))
    fprintf(statements->file, "c[%zu]", statements->slot[node] - 1);
  else fprintf(statements->file, "t%zu", statements->number[node]);
}

static void write_repeated(const struct Statements *statements, Node base, int exponent) {
  for (int i = 0; i < exponent; i++) {
    if (i > 0) fputs(" * ", statements->file);
    statements_operand(statements, base);
  }
}

static void write_function(struct Statements *statements, const char *name, Node left, Node right, int arity) {
  fprintf(statements->file, "%s(", name);
  statements_operand(statements, left);
  if (arity == 2) {
    fputs(", ", statements->file);
    statements_operand(statements, right);
  }
  fputs(")", statements->file);
}

static void write_power(struct Statements *statements, Node base, Node exponent) {
  double n = graph_is_constant(statements->graph, exponent) ? graph_value(statements->graph, exponent) : NAN;
  if (fabs(n) == 0.5) {
    if (n < 0) fputs("1.0 / ", statements->file);
    write_function(statements, "sqrt", base, ZERO, 1);
    statements->operation_count += n < 0;
  } else if (n == floor(n) && fabs(n) <= 4) {
    if (n < 0) fputs(n < -1 ? "1.0 / (" : "1.0 / ", statements->file);
    write_repeated(statements, base, (int)fabs(n));
    if (n < -1) fputs(")", statements->file);
    statements->operation_count += (size_t)fabs(n) - (n > 0 ? 2 : 1);
  } else write_function(statements, "pow", base, exponent, 2);
}

static void write_expression(struct Statements *statements, struct Expression expression, enum Operation operation) {
  static const char *const operators[] = {
      [FORM_SUM] = " + ", [FORM_DIFFERENCE] = " - ", [FORM_PRODUCT] = " * ", [FORM_QUOTIENT] = " / "};
  FILE *file = statements->file;
  switch (expression.form) {
  case FORM_NEGATION:
    fputs("-", file);
    statements_operand(statements, expression.left);
    return;
  case FORM_POWER: write_power(statements, expression.left, expression.right); return;
  case FORM_FUNCTION: {
    if (operation == LESS || operation == SIGN) {
      statements_operand(statements, expression.left);
      fputs(operation == LESS ? " < " : " > 0.0 ? 1.0 : ", file);
      statements_operand(statements, operation == LESS ? expression.right : expression.left);
      fputs(operation == LESS ? " ? 1.0 : 0.0" : " < 0.0 ? -1.0 : 0.0", file);
      return;
    }
    const char *name = operation == ABSOLUTE  ? "fabs"
                       : operation == MINIMUM ? "fmin"
                       : operation == MAXIMUM ? "fmax"
                                              : operation_name(operation);
    write_function(statements, name, expression.left, expression.right, expression.arity);
    return;
  }
  default:
    statements_operand(statements, expression.left);
    fputs(operators[expression.form], file);
    statements_operand(statements, expression.right);
  }
}

void statements_emit(struct Statements *statements, const Node *targets, size_t count) {
  const struct Graph *graph = statements->graph;
  size_t *uses = count_uses(statements, targets, count);
  bool *needed = allocate(graph->count, sizeof *needed);
  for (size_t i = 0; i < count; i++) needed[targets[i]] = true;
  for (Node node = (Node)graph->count; node-- > 0;) {
    if (!needed[node] || is_fetched(statements, node) || statements->number[node] > 0) continue;
    struct Expression expression = expression_of(statements, node, uses);
    needed[expression.left] = true;
    if (expression.arity == 2) needed[expression.right] = true;
  }
  for (Node node = 0; node < graph->count; node++) {
    if (!needed[node] || is_fetched(statements, node) || statements->number[node] > 0) continue;
    struct Expression expression = expression_of(statements, node, uses);
    size_t number = ++statements->local_count;
    fprintf(statements->file, "  const double t%zu = ", number);
    write_expression(statements, expression, graph->vertices[node].operation);
    fputs(";\n", statements->file);
    statements->number[node] = number;
    statements->operation_count++;
  }
  free(uses);
  free(needed);
}
