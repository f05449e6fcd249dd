#include "emit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "statements.h"

struct Emitter {
  FILE *file;
  const struct Program *program;
  const struct Equations *equations;
  const struct Graph *graph;
  struct Statements *statements;
  size_t n, states;
};

/* A growing list of nodes. */
struct NodeList {
  Node *nodes;
  size_t count;
};

static void append_nodes(struct NodeList *list, const Node *nodes, size_t count) {
  list->nodes = reallocate(list->nodes, list->count + count, sizeof *list->nodes);
  for (size_t i = 0; i < count; i++) list->nodes[list->count++] = nodes[i];
}

static bool is_looped(const struct Equations *equations, size_t coordinate) {
  return !equations->explicit_form && !equations->unrolled[equations->block[coordinate]];
}

static bool is_of_parameters(const struct Graph *graph, Node node) {
  return (graph->vertices[node].kinds & ~(1u << PARAMETER)) == 0;
}

static bool pivot_is_prepared(const struct Graph *graph, const struct Pivot *pivot) {
  return is_of_parameters(graph, pivot->value) && is_of_parameters(graph, pivot->scale);
}

/* What must be computed before the accelerations are known: themselves, or M and the right side of large blocks. */
static struct NodeList acceleration_targets(const struct Emitter *emitter) {
  const struct Equations *equations = emitter->equations;
  struct NodeList targets = {0};
  size_t n = emitter->n;
  for (size_t i = 0; i < n; i++) {
    if (!is_looped(equations, i)) {
      append_nodes(&targets, &equations->acceleration[i], 1);
      continue;
    }
    append_nodes(&targets, &equations->right_side[i], 1);
    for (size_t j = 0; j <= i; j++)
      if (equations->block[j] == equations->block[i]) append_nodes(&targets, &equations->mass[i * n + j], 1);
  }
  for (size_t i = 0; i < equations->pivot_count; i++) {
    const struct Pivot *pivot = &equations->pivots[i];
    if (pivot_is_prepared(emitter->graph, pivot)) continue;
    append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  return targets;
}

static void emit_pivot_check(const struct Emitter *emitter, const struct Pivot *pivot) {
  const struct Statements *statements = emitter->statements;
  const struct {
    Node small, large;
    double share; /* below this share of large, small is a rounding error */
  } conditions[] = {{pivot->value, pivot->diagonal, 1e-14}, {pivot->diagonal, pivot->scale, 1e-28}};
  bool checked = false;
  fputs("  if (!(", emitter->file);
  for (int i = 0; i < 2; i++) {
    if (conditions[i].small == conditions[i].large) continue;
    if (checked) fputs(" && ", emitter->file);
    statements_operand(statements, conditions[i].small);
    fprintf(emitter->file, " > %g * ", conditions[i].share);
    statements_operand(statements, conditions[i].large);
    checked = true;
  }
  if (!checked) {
    statements_operand(statements, pivot->value);
    fputs(" > 0.0", emitter->file);
  }
  fprintf(emitter->file, ")) return %zu;\n", pivot->coordinate + 1);
}

/* The members of a block; returns their number. */
static size_t block_members(const struct Equations *equations, size_t block, size_t *members) {
  size_t count = 0;
  for (size_t i = 0; i < equations->count; i++)
    if (equations->block[i] == block) members[count++] = i;
  return count;
}

static void emit_array(const struct Emitter *emitter, const char *name, size_t block, const Node *nodes,
                       size_t count) {
  fprintf(emitter->file, "  double %s%zu[] = {", name, block);
  for (size_t i = 0; i < count; i++) {
    if (i > 0) fputs(", ", emitter->file);
    statements_operand(emitter->statements, nodes[i]);
  }
  fputs("};\n", emitter->file);
}

/* Multiplications, divisions and additions of factoring and solving a block of this size. */
static size_t factor_operations(size_t n) {
  return n * (n * n - 1) / 3 + n * (n - 1) + 2 * n * (n - 1) + n;
}

/* Factors a large block and solves it for its accelerations, written to target. */
static void emit_block_solution(struct Emitter *emitter, size_t block, const char *target) {
  const struct Equations *equations = emitter->equations;
  size_t n = emitter->n, *members = allocate(n, sizeof *members);
  size_t count = block_members(equations, block, members);
  struct NodeList mass = {0}, right = {0};
  for (size_t i = 0; i < count; i++) {
    append_nodes(&right, &equations->right_side[members[i]], 1);
    for (size_t j = 0; j <= i; j++) append_nodes(&mass, &equations->mass[members[i] * n + members[j]], 1);
  }
  emit_array(emitter, "mass", block, mass.nodes, mass.count);
  emit_array(emitter, "x", block, right.nodes, right.count);
  fprintf(emitter->file, "  static const int coordinate%zu[] = {0", block);
  for (size_t i = 0; i < count; i++) fprintf(emitter->file, ", %zu", members[i] + 1);
  fprintf(emitter->file, "};\n  const size_t singular%zu = ldlt_factor(%zu, mass%zu);\n", block, count, block);
  fprintf(emitter->file, "  if (singular%zu != 0) return coordinate%zu[singular%zu];\n", block, block, block);
  fprintf(emitter->file, "  ldlt_solve(%zu, mass%zu, x%zu);\n", count, block, block);
  for (size_t i = 0; i < count; i++)
    fprintf(emitter->file, "  %s[%zu] = x%zu[%zu];\n", target, members[i], block, i);
  emitter->statements->operation_count += factor_operations(count);
  free(mass.nodes);
  free(right.nodes);
  free(members);
}

static bool block_is_looped(const struct Equations *equations, size_t block) {
  return !equations->explicit_form && !equations->unrolled[block];
}

static bool has_loops(const struct Equations *equations) {
  for (size_t block = 0; block < equations->block_count; block++)
    if (block_is_looped(equations, block)) return true;
  return false;
}

/* The accelerations into target[0..n-1], with all checks. */
static void emit_accelerations(struct Emitter *emitter, const char *target) {
  const struct Equations *equations = emitter->equations;
  struct NodeList targets = acceleration_targets(emitter);
  statements_emit(emitter->statements, targets.nodes, targets.count);
  free(targets.nodes);
  for (size_t i = 0; i < equations->pivot_count; i++)
    if (!pivot_is_prepared(emitter->graph, &equations->pivots[i]))
      emit_pivot_check(emitter, &equations->pivots[i]);
  for (size_t i = 0; i < emitter->n; i++) {
    if (is_looped(equations, i)) continue;
    fprintf(emitter->file, "  %s[%zu] = ", target, i);
    statements_operand(emitter->statements, equations->acceleration[i]);
    fputs(";\n", emitter->file);
  }
  for (size_t block = 0; block < equations->block_count; block++)
    if (block_is_looped(equations, block)) emit_block_solution(emitter, block, target);
}

static void emit_assignment(const struct Emitter *emitter, const char *array, size_t index, Node node) {
  fprintf(emitter->file, "  %s[%zu] = ", array, index);
  statements_operand(emitter->statements, node);
  fputs(";\n", emitter->file);
}

/* Declares a local pointer where the body, already written to a buffer, uses its name. */
static void emit_pointer(FILE *file, const char *body, const char *name, const char *source) {
  char *use = format_text("%s[", name);
  size_t length = strlen(use);
  for (const char *found = strstr(body, use); found != NULL; found = strstr(found + length, use)) {
    char before = found == body ? ' ' : found[-1];
    if (strchr(" (-{", before) == NULL) continue;
    fprintf(file, "  const double *%s = %s;\n", name, source);
    break;
  }
  free(use);
}

/* Runs a body writer into a buffer, then writes the function with just the declarations that the body uses. */
static void emit_function(struct Emitter *emitter, const char *comment, const char *signature,
                          void (*body)(struct Emitter *, size_t), size_t argument) {
  FILE *file = emitter->file;
  char *text = NULL, *velocity = format_text("point->state + %zu", emitter->n);
  char *seed_velocity = format_text("seed->state + %zu", emitter->n);
  size_t length = 0;
  emitter->file = open_memstream(&text, &length);
  if (emitter->file == NULL) {
    fputs("lagc: out of memory\n", stderr);
    exit(1);
  }
  statements_begin(emitter->statements, emitter->file);
  body(emitter, argument);
  fclose(emitter->file);
  emitter->file = file;
  fprintf(file, "/* %s; %zu operations */\nstatic %s {\n", comment, emitter->statements->operation_count,
          signature);
  const char *const pointers[][2] = {{"q", "point->state"},      {"v", velocity},
                                     {"u", "point->input"},      {"p", "point->parameter"},
                                     {"c", "point->prepared"},   {"dq", "seed->state"},
                                     {"dv", seed_velocity},      {"du", "seed->input"},
                                     {"dp", "seed->parameter"}};
  bool has_point = strstr(signature, "*point") != NULL;
  for (size_t i = 0; has_point && i < sizeof pointers / sizeof *pointers; i++)
    emit_pointer(file, text, pointers[i][0], pointers[i][1]);
  fprintf(file, "%s}\n\n", text);
  free(text);
  free(velocity);
  free(seed_velocity);
}

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

/* Solves the large blocks once more, for right sides in the nodes; the first n elements of target[]. */
static void emit_along_blocks(struct Emitter *emitter, const Node *nodes, size_t stride, const char *target,
                              size_t number) {
  const struct Equations *equations = emitter->equations;
  size_t *members = allocate(emitter->n, sizeof *members);
  for (size_t block = 0; block < equations->block_count; block++) {
    if (!block_is_looped(equations, block)) continue;
    size_t count = block_members(equations, block, members);
    char *name = format_text("y%zu_", number);
    struct NodeList right = {0};
    for (size_t i = 0; i < count; i++) append_nodes(&right, &nodes[members[i] * stride], 1);
    emit_array(emitter, name, block, right.nodes, right.count);
    fprintf(emitter->file, "  ldlt_solve(%zu, mass%zu, %s%zu);\n", count, block, name, block);
    for (size_t i = 0; i < count; i++)
      fprintf(emitter->file, "  %s[%zu] = %s%zu[%zu];\n", target, members[i], name, block, i);
    free(right.nodes);
    free(name);
  }
  free(members);
}

static bool uses_accelerations(const struct Graph *graph, const Node *nodes, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (graph_depends_on(graph, nodes[i], ACCELERATION)) return true;
  return false;
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
  emit_along_blocks(emitter, along, 1, "change", 0);
  if (emitter->states > 2 * n) {
    statements_emit(emitter->statements, &emitter->program->power_along, 1);
    emit_assignment(emitter, "derivative", 2 * n, emitter->program->power_along);
  }
  fputs("  return 0;\n", emitter->file);
}

static void jacobian_body(struct Emitter *emitter, size_t unused) {
  (void)unused;
  size_t n = emitter->n, states = emitter->states;
  const Node *jacobian = emitter->program->jacobian;
  emit_local_accelerations(emitter, jacobian, n * states);
  statements_emit(emitter->statements, jacobian, n * states);
  if (states > 2 * n) statements_emit(emitter->statements, emitter->program->power_jacobian, states);
  fprintf(emitter->file, "  memset(jacobian, 0, %zu * sizeof *jacobian);\n  double *column;\n", states * states);
  for (size_t j = 0; j < 2 * n; j++) {
    fprintf(emitter->file, "  column = jacobian + %zu;\n", j * states);
    if (j >= n) fprintf(emitter->file, "  column[%zu] = 1.0;\n", j - n);
    fprintf(emitter->file, "  column += %zu;\n", n);
    for (size_t i = 0; i < n; i++)
      if (!is_looped(emitter->equations, i) && jacobian[i * states + j] != ZERO)
        emit_assignment(emitter, "column", i, jacobian[i * states + j]);
    emit_along_blocks(emitter, jacobian + j, states, "column", j);
    if (states > 2 * n) emit_assignment(emitter, "column", n, emitter->program->power_jacobian[j]);
  }
  fputs("  return 0;\n", emitter->file);
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
    for (size_t j = 0; j < states; j++)
      emit_assignment(emitter, "matrix", i * columns + j, linear->a[i * states + j]);
    for (size_t j = 0; j < inputs; j++)
      emit_assignment(emitter, "matrix", i * columns + states + j, linear->b[i * inputs + j]);
    emit_assignment(emitter, "matrix", i * columns + states + inputs, linear->c[i]);
  }
}

static Node result_node(const struct Program *program, size_t index) {
  return program->interface->variables[interface_find(program->interface, VARIABLE_RESULT, index)].node;
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

static bool is_output(const struct Interface *interface, size_t result) {
  return interface->variables[interface_find(interface, VARIABLE_RESULT, result)].entry.is_output;
}

static void emit_results(struct Emitter *emitter) {
  const struct Interface *interface = emitter->program->interface;
  for (size_t i = 0; i < interface->result_count; i++) {
    const char *name = interface->variables[interface_find(interface, VARIABLE_RESULT, i)].entry.name;
    char *signature = format_text("double result%zu(const struct Point *point, const double *a)", i);
    emit_function(emitter, name, signature, result_body, i);
    free(signature);
    if (!is_output(interface, i)) continue;
    char *comment = format_text("%s along a direction", name);
    signature = format_text("double result%zu_along(const struct Point *point, const struct Seed *seed, "
                            "const double *a, const double *da)",
                            i);
    emit_function(emitter, comment, signature, result_along_body, i);
    free(signature);
    free(comment);
  }
}

static void write_string(FILE *file, const char *text) {
  fputc('"', file);
  for (; *text != '\0'; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', file);
    fputc(*text, file);
  }
  fputc('"', file);
}

static void emit_variable_table(const struct Emitter *emitter) {
  static const char *const kinds[] = {
      [VARIABLE_TIME] = "VARIABLE_TIME",           [VARIABLE_STATE] = "VARIABLE_STATE",
      [VARIABLE_DERIVATIVE] = "VARIABLE_DERIVATIVE", [VARIABLE_INPUT] = "VARIABLE_INPUT",
      [VARIABLE_PARAMETER] = "VARIABLE_PARAMETER", [VARIABLE_RESULT] = "VARIABLE_RESULT",
      [VARIABLE_STATISTIC] = "VARIABLE_STATISTIC",
  };
  const struct Interface *interface = emitter->program->interface;
  fputs("static const struct ScalarVariable variables[] = {\n", emitter->file);
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    fputs("    {", emitter->file);
    write_string(emitter->file, entry->name);
    fprintf(emitter->file, ", %s, %zu, %s, ", kinds[entry->kind], entry->index,
            entry->is_output ? "true" : "false");
    write_c_number(emitter->file, isnan(entry->start) ? 0.0 : entry->start);
    fputs(", ", emitter->file);
    write_c_number(emitter->file, isnan(entry->minimum) ? -INFINITY : entry->minimum);
    fputs(", ", emitter->file);
    write_c_number(emitter->file, isnan(entry->maximum) ? INFINITY : entry->maximum);
    fputs("},\n", emitter->file);
  }
  fputs("};\n\n", emitter->file);
}

static void emit_result_table(const struct Emitter *emitter) {
  const struct Interface *interface = emitter->program->interface;
  if (interface->result_count == 0) return;
  fputs("static const struct Result results[] = {\n", emitter->file);
  for (size_t i = 0; i < interface->result_count; i++) {
    bool uses_acceleration = graph_depends_on(emitter->graph, result_node(emitter->program, i), ACCELERATION);
    if (is_output(interface, i)) fprintf(emitter->file, "    {result%zu, result%zu_along, ", i, i);
    else fprintf(emitter->file, "    {result%zu, NULL, ", i);
    fprintf(emitter->file, "%s},\n", uses_acceleration ? "true" : "false");
  }
  fputs("};\n\n", emitter->file);
}

/* The names that a coordinate's inertia depends on, for the message that it has vanished. */
static void emit_inertia_table(const struct Emitter *emitter) {
  const struct Graph *graph = emitter->graph;
  if (emitter->n == 0) return;
  bool *needed = allocate(graph->count, sizeof *needed);
  fputs("static const char *const inertia_depends_on[] = {\n", emitter->file);
  for (size_t i = 0; i < emitter->n; i++) {
    graph_mark(graph, &emitter->equations->mass[i * emitter->n + i], 1, needed);
    fputs("    \"", emitter->file);
    const char *separator = "";
    for (size_t s = 0; s < graph->symbol_count; s++) {
      if (!needed[graph->symbols[s].node]) continue;
      fprintf(emitter->file, "%s%s", separator, graph->symbols[s].name);
      separator = ", ";
    }
    fputs("\",\n", emitter->file);
  }
  fputs("};\n\n", emitter->file);
  free(needed);
}

static void emit_nominal_table(const struct Emitter *emitter) {
  if (emitter->states == 0) return;
  fputs("static const double nominal[] = {", emitter->file);
  for (size_t i = 0; i < emitter->states; i++) {
    const struct Interface *interface = emitter->program->interface;
    double nominal = interface->variables[interface_find(interface, VARIABLE_STATE, i)].nominal;
    if (i > 0) fputs(", ", emitter->file);
    write_c_number(emitter->file, isnan(nominal) ? 1.0 : nominal);
  }
  fputs("};\n\n", emitter->file);
}

static void emit_description(const struct Emitter *emitter, const char *guid) {
  static const char *const solvers[] = {
      [SOLVER_ERK] = "&solver_erk", [SOLVER_BDF] = "&solver_bdf", [SOLVER_EXACT] = "&solver_exact",
      [SOLVER_NONE] = "NULL"};
  const struct Program *program = emitter->program;
  const struct Interface *interface = program->interface;
  FILE *file = emitter->file;
  bool moves = emitter->n > 0;
  fprintf(file, "const struct Lagrangian lagrangian = {\n    .name = \"%s\",\n    .guid = \"%s\",\n",
          program->model->name, guid);
  fprintf(file, "    .coordinate_count = %zu,\n    .state_count = %zu,\n    .input_count = %zu,\n", emitter->n,
          emitter->states, program->model->inputs.count);
  fprintf(file, "    .parameter_count = %zu,\n    .prepared_count = %zu,\n    .variable_count = %zu,\n",
          program->model->parameters.count, emitter->statements->prepared_count, interface->count);
  fprintf(file, "    .result_count = %zu,\n    .variables = variables,\n    .results = %s,\n",
          interface->result_count, interface->result_count > 0 ? "results" : "NULL");
  fprintf(file, "    .nominal = %s,\n    .inertia_depends_on = %s,\n    .tolerance = ", moves ? "nominal" : "NULL",
          moves ? "inertia_depends_on" : "NULL");
  write_c_number(file, interface_tolerance(program->model));
  fprintf(file, ",\n    .depends_on_time = %s,\n    .solver = %s,\n    .prepare = prepare,\n",
          interface->depends_on_time ? "true" : "false", solvers[interface->method]);
  fprintf(file, "    .derivatives = %s,\n    .directional = %s,\n", moves ? "derivatives" : "NULL",
          moves ? "directional" : "NULL");
  fprintf(file, "    .jacobian = %s,\n    .linear = %s,\n};\n", program->jacobian != NULL ? "jacobian" : "NULL",
          program->linear != NULL ? "linear" : "NULL");
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
  fprintf(file, "/* Equations of motion of %s, written by lagc. */\n", program->model->name);
  fputs("#include <math.h>\n#include <string.h>\n\n#include \"lagrangian.h\"\n", file);
  fputs(has_loops(emitter.equations) ? "#include \"ldlt.h\"\n" : "", file);
  fputs(emitter.n > 0 ? "#include \"solver.h\"\n\n" : "\n", file);
  emit_function(&emitter, "What depends on parameters alone", "int prepare(const double *p, double *prepared)",
                prepare_body, 0);
  if (emitter.n > 0) {
    emit_function(&emitter, "d state / dt", "int derivatives(const struct Point *point, double *derivative)",
                  derivatives_body, 0);
    emit_function(&emitter, "d state / dt along a direction",
                  "int directional(const struct Point *point, const struct Seed *seed, double *derivative)",
                  directional_body, 0);
  }
  if (program->jacobian != NULL)
    emit_function(&emitter, "Jacobian matrix", "int jacobian(const struct Point *point, double *jacobian)",
                  jacobian_body, 0);
  if (program->linear != NULL)
    emit_function(&emitter, "A, B and c", "void linear(const double *p, const double *c, double *matrix)",
                  linear_body, 0);
  emit_results(&emitter);
  emit_variable_table(&emitter);
  emit_result_table(&emitter);
  emit_inertia_table(&emitter);
  emit_nominal_table(&emitter);
  emit_description(&emitter, guid);
  statements_free(emitter.statements);
}
