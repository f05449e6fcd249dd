#include "write/emit_tables.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

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
      [VARIABLE_TIME] = "VARIABLE_TIME",
      [VARIABLE_STATE] = "VARIABLE_STATE",
      [VARIABLE_DERIVATIVE] = "VARIABLE_DERIVATIVE",
      [VARIABLE_INPUT] = "VARIABLE_INPUT",
      [VARIABLE_PARAMETER] = "VARIABLE_PARAMETER",
      [VARIABLE_RESULT] = "VARIABLE_RESULT",
      [VARIABLE_STATISTIC] = "VARIABLE_STATISTIC",
  };
  const struct Interface *interface = emitter->program->interface;
  fputs("static const struct ScalarVariable variables[] = {\n", emitter->file);
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    fputs("    {", emitter->file);
    write_string(emitter->file, entry->name);
    fprintf(emitter->file, ", %s, %zu, %s, ", kinds[entry->kind], entry->index, entry->is_output ? "true" : "false");
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
    if (result_is_output(interface, i)) fprintf(emitter->file, "    {result%zu, result%zu_along, ", i, i);
    else fprintf(emitter->file, "    {result%zu, NULL, ", i);
    fprintf(emitter->file, "%s},\n", uses_acceleration ? "true" : "false");
  }
  fputs("};\n\n", emitter->file);
}

/* What the elimination of coordinate i rests on: the mass matrix of its block up to row and column i. */
static struct NodeList inertia_of(const struct Equations *equations, size_t i) {
  struct NodeList inertia = {0};
  for (size_t k = 0; k <= i; k++)
    for (size_t j = 0; j <= k; j++)
      if (equations->block[k] == equations->block[i] && equations->block[j] == equations->block[i])
        append_nodes(&inertia, &equations->mass[k * equations->count + j], 1);
  return inertia;
}

/* C allows 4095 characters in a string, and a message has its use with fewer. */
enum { INERTIA_TEXT_LIMIT = 1000 };

/* The names that a coordinate's inertia depends on, for the message that it has vanished. */
static void emit_inertia_table(const struct Emitter *emitter) {
  const struct Graph *graph = emitter->graph;
  if (emitter->n == 0) return;
  bool *needed = allocate(graph->count, sizeof *needed);
  fputs("static const char *const inertia_depends_on[] = {\n", emitter->file);
  for (size_t i = 0; i < emitter->n; i++) {
    struct NodeList inertia = inertia_of(emitter->equations, i);
    graph_mark(graph, inertia.nodes, inertia.count, needed);
    free(inertia.nodes);
    fputs("    \"", emitter->file);
    size_t length = 0;
    for (size_t s = 0; s < graph->symbol_count && length <= INERTIA_TEXT_LIMIT; s++) {
      if (!needed[graph->symbols[s].node]) continue;
      const char *name = length + strlen(graph->symbols[s].name) <= INERTIA_TEXT_LIMIT ? graph->symbols[s].name : "...";
      fprintf(emitter->file, "%s%s", length > 0 ? ", " : "", name);
      length += strlen(graph->symbols[s].name) + 2;
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
  const struct Program *program = emitter->program;
  const struct Interface *interface = program->interface;
  FILE *file = emitter->file;
  bool moves = emitter->n > 0;
  const char *solver = moves ? method_solver(interface->method, emitter->states, emitter->jacobian_elements) : NULL;
  if (moves) fprintf(file, "extern const struct Solver %s;\n\n", solver);
  fprintf(file, "const struct Lagrangian lagrangian = {\n    .name = \"%s\",\n    .guid = \"%s\",\n",
          program->model->name, guid);
  fprintf(file, "    .coordinate_count = %zu,\n    .state_count = %zu,\n    .input_count = %zu,\n", emitter->n,
          emitter->states, program->model->inputs.count);
  fprintf(file, "    .parameter_count = %zu,\n    .prepared_count = %zu,\n    .variable_count = %zu,\n",
          program->model->parameters.count, emitter->statements->prepared_count, interface->count);
  fprintf(file, "    .result_count = %zu,\n    .variables = variables,\n    .results = %s,\n", interface->result_count,
          interface->result_count > 0 ? "results" : "NULL");
  fprintf(file, "    .nominal = %s,\n    .inertia_depends_on = %s,\n    .tolerance = ", moves ? "nominal" : "NULL",
          moves ? "inertia_depends_on" : "NULL");
  write_c_number(file, interface_tolerance(program->model));
  fputs(",\n    .max_step = ", file);
  write_c_number(file, isnan(program->model->max_step) ? INFINITY : program->model->max_step);
  fprintf(file, ",\n    .depends_on_time = %s,\n    .solver = %s%s,\n    .prepare = prepare,\n",
          interface->depends_on_time ? "true" : "false", moves ? "&" : "", moves ? solver : "NULL");
  fprintf(file, "    .derivatives = %s,\n    .directional = %s,\n", moves ? "derivatives" : "NULL",
          moves ? "directional" : "NULL");
  if (emitter->has_series)
    fprintf(file, "    .series_rows = %zu,\n    .start = start,\n    .series = series,\n", emitter->series_rows);
  if (emitter->has_series && emitter->has_limit) fputs("    .limit = limit,\n", file);
  fprintf(file, "    .output_derivative_order = %d,\n", interface->output_derivative_order);
  if (program->output_series != NULL)
    fprintf(file, "    .output_series_rows = %zu,\n    .output_series = output_series,\n", emitter->output_series_rows);
  if (program->jacobian != NULL)
    fprintf(file, "    .jacobian_pattern = {%zu, jacobian_start, jacobian_row},\n", emitter->jacobian_elements);
  fprintf(file, "    .jacobian = %s,\n    .linear = %s,\n};\n", program->jacobian != NULL ? "jacobian" : "NULL",
          program->linear != NULL ? "linear" : "NULL");
}

void emit_tables(const struct Emitter *emitter, const char *guid) {
  emit_variable_table(emitter);
  emit_result_table(emitter);
  emit_inertia_table(emitter);
  emit_nominal_table(emitter);
  emit_description(emitter, guid);
}
