#include "write/emit.h"

#include <stdlib.h>
#include <string.h>

#include "write/emit_accelerations.h"
#include "write/emit_series.h"
#include "write/emit_tables.h"
#include "memory.h"

static void derivatives_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  char *acceleration = format_text("derivative + %zu", emitter->n);
  fprintf(emitter->file, "  double *a = %s;\n", acceleration);
  emit_accelerations(emitter, "a");
  if (emitter->states > 2 * emitter->n) statements_emit(emitter->statements, &emitter->equations->power, 1);
  for (size_t i = 0; i < emitter->n; i++)
    emit_assignment(emitter, "derivative", i, emitter->program->model->velocities.items[i].node);
  if (emitter->states > 2 * emitter->n)
    emit_assignment(emitter, "derivative", 2 * emitter->n, emitter->equations->power);
  fputs("  return 0;\n", emitter->file);
  free(acceleration);
}

/* The accelerations into a local array a[], where differentiated equations hold them or blocks must be factored. */
static void emit_local_accelerations(struct Emitter *emitter, const Node *nodes, size_t count) {
  if (!uses_accelerations(emitter->graph, nodes, count) && !has_loops(emitter->equations)) return;
  fprintf(emitter->file, "  double a[%zu];\n", emitter->n);
  emit_accelerations(emitter, "a");
}

static void directional_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  const Node *along = emitter->program->along;
  size_t n = emitter->n;
  emit_local_accelerations(emitter, along, n);
  statements_emit(emitter->statements, along, n);
  for (size_t i = 0; i < n; i++) fprintf(emitter->file, "  derivative[%zu] = dv[%zu];\n", i, i);
  fprintf(emitter->file, "  double *change = derivative + %zu;\n", n);
  for (size_t i = 0; i < n; i++)
    if (!is_looped(emitter->equations, i)) emit_assignment(emitter, "change", i, along[i]);
  emit_along_blocks(emitter, along, 1, "change", NULL, 0);
  if (emitter->states > 2 * n) {
    statements_emit(emitter->statements, &emitter->program->power_along, 1);
    emit_assignment(emitter, "derivative", 2 * n, emitter->program->power_along);
  }
  fputs("  return 0;\n", emitter->file);
}

/* Whether element (row, column) of the Jacobian may differ from 0. */
static bool jacobian_has(const struct Emitter *emitter, size_t row, size_t column) {
  const struct Equations *equations = emitter->equations;
  size_t n = emitter->n, states = emitter->states;
  if (column >= 2 * n) return false;
  if (row < n) return column == n + row;
  if (row == 2 * n) return emitter->program->power_jacobian[column] != ZERO;
  size_t i = row - n;
  if (emitter->program->jacobian[i * states + column] != ZERO) return true;
  /* A block that is factored at run time has no zeros. */
  for (size_t k = 0; is_looped(equations, i) && k < n; k++)
    if (equations->block[k] == equations->block[i] && emitter->program->jacobian[k * states + column] != ZERO)
      return true;
  return false;
}

/* The pattern of the Jacobian by columns; returns the number of its elements. */
static size_t emit_pattern(const struct Emitter *emitter) {
  size_t states = emitter->states, count = 0, *start = allocate(states + 1, sizeof *start);
  fputs("static const int jacobian_row[] = {", emitter->file);
  for (size_t j = 0; j < states; j++) {
    for (size_t i = 0; i < states; i++)
      if (jacobian_has(emitter, i, j)) fprintf(emitter->file, "%s%zu", count++ > 0 ? ", " : "", i);
    start[j + 1] = count;
  }
  fputs("};\nstatic const int jacobian_start[] = {", emitter->file);
  for (size_t j = 0; j <= states; j++) fprintf(emitter->file, "%s%zu", j > 0 ? ", " : "", start[j]);
  fputs("};\n\n", emitter->file);
  free(start);
  return count;
}

static void jacobian_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  size_t n = emitter->n, states = emitter->states, count = 0, *place = allocate(n, sizeof *place);
  const Node *jacobian = emitter->program->jacobian;
  emit_local_accelerations(emitter, jacobian, n * states);
  statements_emit(emitter->statements, jacobian, n * states);
  if (states > 2 * n) statements_emit(emitter->statements, emitter->program->power_jacobian, states);
  for (size_t j = 0; j < 2 * n; j++) {
    if (j >= n) fprintf(emitter->file, "  values[%zu] = 1.0;\n", count++);
    for (size_t i = 0; i < n; i++) {
      place[i] = NOWHERE;
      if (!jacobian_has(emitter, n + i, j)) continue;
      place[i] = count++;
      if (!is_looped(emitter->equations, i)) emit_assignment(emitter, "values", place[i], jacobian[i * states + j]);
    }
    emit_along_blocks(emitter, jacobian + j, states, "values", place, j);
    if (states > 2 * n && jacobian_has(emitter, 2 * n, j))
      emit_assignment(emitter, "values", count++, emitter->program->power_jacobian[j]);
  }
  fputs("  return 0;\n", emitter->file);
  free(place);
}

static void prepare_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  struct Statements *statements = emitter->statements;
  struct NodeList targets = {0};
  append_nodes(&targets, statements->prepared, statements->prepared_count);
  for (size_t i = 0; i < emitter->equations->pivot_count; i++) {
    const struct Pivot *pivot = &emitter->equations->pivots[i];
    if (!pivot_is_prepared(emitter->graph, pivot)) continue;
    append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  statements->preparing = true;
  statements_emit(statements, targets.nodes, targets.count);
  for (size_t i = 0; i < emitter->equations->pivot_count; i++)
    if (pivot_is_prepared(emitter->graph, &emitter->equations->pivots[i]))
      emit_pivot_check(emitter, &emitter->equations->pivots[i]);
  for (size_t i = 0; i < statements->prepared_count; i++)
    emit_assignment(emitter, "prepared", i, statements->prepared[i]);
  fputs("  return 0;\n", emitter->file);
  statements->preparing = false;
  free(targets.nodes);
}

static void linear_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  const struct LinearSystem *linear = emitter->program->linear;
  size_t states = linear->states, inputs = linear->inputs, columns = states + inputs + 1;
  for (size_t i = 0; i < states; i++) {
    for (size_t j = 0; j < states; j++) emit_assignment(emitter, "matrix", i * columns + j, linear->a[i * states + j]);
    for (size_t j = 0; j < inputs; j++)
      emit_assignment(emitter, "matrix", i * columns + states + j, linear->b[i * inputs + j]);
    emit_assignment(emitter, "matrix", i * columns + states + inputs, linear->c[i]);
  }
}

static void emit_return(struct Emitter *emitter, Node node) {
  statements_emit(emitter->statements, &node, 1);
  fputs("  return ", emitter->file);
  statements_operand(emitter->statements, node);
  fputs(";\n", emitter->file);
}

static void result_body(struct Emitter *emitter, size_t index) {
  emit_return(emitter, result_node(emitter->program, index));
}

static void result_along_body(struct Emitter *emitter, size_t index) {
  emit_return(emitter, emitter->program->result_along[index]);
}

static void emit_results(struct Emitter *emitter) {
  const struct Interface *interface = emitter->program->interface;
  for (size_t i = 0; i < interface->result_count; i++) {
    const char *name = interface->variables[interface_find(interface, VARIABLE_RESULT, i)].entry.name;
    char *signature = format_text("double result%zu(const struct Point *point, const double *a)", i);
    emit_function(emitter, name, signature, result_body, i);
    free(signature);
    if (!result_is_output(interface, i)) continue;
    char *comment = format_text("%s along a direction", name);
    signature = format_text("double result%zu_along(const struct Point *point, const struct Seed *seed, "
                            "const double *a, const double *da)",
                            i);
    emit_function(emitter, comment, signature, result_along_body, i);
    free(signature);
    free(comment);
  }
}

static void announce_all(struct Emitter *emitter) {
  const struct Program *program = emitter->program;
  struct NodeList targets = acceleration_targets(emitter);
  size_t n = emitter->n, states = emitter->states;
  append_nodes(&targets, program->along, n);
  if (states > 2 * n) append_nodes(&targets, (const Node[]){program->equations->power, program->power_along}, 2);
  if (program->jacobian != NULL) append_nodes(&targets, program->jacobian, n * states);
  if (program->jacobian != NULL) append_nodes(&targets, program->power_jacobian, states);
  if (program->linear != NULL) {
    append_nodes(&targets, program->linear->a, program->linear->states * program->linear->states);
    append_nodes(&targets, program->linear->b, program->linear->states * program->linear->inputs);
    append_nodes(&targets, program->linear->c, program->linear->states);
  }
  for (size_t i = 0; i < program->interface->result_count; i++) {
    Node node = result_node(program, i);
    append_nodes(&targets, &node, 1);
  }
  append_nodes(&targets, program->result_along, program->interface->result_count);
  const struct SeriesPlan *const plans[] = {program->series, program->output_series};
  for (int i = 0; i < 2; i++)
    if (plans[i] != NULL) append_nodes(&targets, plans[i]->targets, plans[i]->count);
  statements_announce(emitter->statements, targets.nodes, targets.count);
  statements_settle(emitter->statements);
  free(targets.nodes);
}

void emit_system(FILE *file, const struct Program *program, const char *guid) {
  struct Emitter emitter = {.file = file,
                            .program = program,
                            .equations = program->equations,
                            .graph = program->model->graph,
                            .statements = statements_create(program->model->graph),
                            .n = program->equations->count,
                            .states = program->interface->state_count};
  announce_all(&emitter);
  struct SeriesWriter *series = program->series == NULL ? NULL : series_writer_create(&emitter);
  if (series != NULL && program->interface->method->series != ALL_TERMS && !emitter.has_limit) {
    series_writer_free(series);
    series = NULL;
  }
  emitter.has_series = series != NULL;
  fprintf(file, "/* Equations of motion of %s, written by lagc. */\n", program->model->name);
  fputs(series != NULL && !series->is_unrolled ? "#define SERIES_ROLLED 1\n" : "", file);
  fputs("#include <math.h>\n#include <string.h>\n\n#include \"lagrangian.h\"\n", file);
  fputs(has_loops(emitter.equations) ? "#include \"ldlt.h\"\n" : "", file);
  fputs("\n", file);
  emit_function(&emitter, "What depends on parameters alone", "int prepare(const double *p, double *prepared)",
                prepare_body, 0);
  if (emitter.n > 0) {
    emit_function(&emitter, "d state / dt", "int derivatives(const struct Point *point, double *derivative)",
                  derivatives_body, 0);
    emit_function(&emitter, "d state / dt along a direction",
                  "int directional(const struct Point *point, const struct Seed *seed, double *derivative)",
                  directional_body, 0);
  }
  if (program->jacobian != NULL) {
    emit_function(&emitter, "Jacobian matrix", "int jacobian(const struct Point *point, double *values)", jacobian_body,
                  0);
    emitter.jacobian_elements = emit_pattern(&emitter);
  }
  if (series != NULL) emitter.series_rows = emit_series(&emitter, series);
  if (program->output_series != NULL) emitter.output_series_rows = emit_output_series(&emitter);
  if (program->linear != NULL)
    emit_function(&emitter, "A, B and c", "void linear(const double *p, const double *c, double *matrix)", linear_body,
                  0);
  emit_results(&emitter);
  emit_tables(&emitter, guid);
  statements_free(emitter.statements);
}
