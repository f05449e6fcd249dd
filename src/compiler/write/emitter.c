#include "write/emitter.h"

#include <stdlib.h>
#include <string.h>

#include "memory.h"

void append_nodes(struct NodeList *list, const Node *nodes, size_t count) {
  list->nodes = reallocate(list->nodes, list->count + count, sizeof *list->nodes);
  for (size_t i = 0; i < count; i++) list->nodes[list->count++] = nodes[i];
}

void emit_assignment(const struct Emitter *emitter, const char *array, size_t index, Node node) {
  fprintf(emitter->file, "  %s[%zu] = ", array, index);
  statements_operand(emitter->statements, node);
  fputs(";\n", emitter->file);
}

Node result_node(const struct Program *program, size_t index) {
  return program->interface->variables[interface_find(program->interface, VARIABLE_RESULT, index)].node;
}

bool result_is_output(const struct Interface *interface, size_t result) {
  return interface->variables[interface_find(interface, VARIABLE_RESULT, result)].entry.is_output;
}

bool uses_accelerations(const struct Graph *graph, const Node *nodes, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (graph_depends_on(graph, nodes[i], ACCELERATION)) return true;
  return false;
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

void emit_function(struct Emitter *emitter, const char *comment, const char *signature,
                   void (*body)(struct Emitter *, size_t), size_t argument) {
  FILE *file = emitter->file;
  char *text = NULL, *velocity = format_text("point->state + %zu", emitter->n);
  char *seed_velocity = format_text("seed->state + %zu", emitter->n);
  size_t length = 0;
  emitter->file = open_text(&text, &length);
  statements_begin(emitter->statements, emitter->file);
  body(emitter, argument);
  fclose(emitter->file);
  emitter->file = file;
  fprintf(file, "/* %s; %zu operations */\nstatic %s {\n", comment, emitter->statements->operation_count, signature);
  const char *const pointers[][2] = {{"q", "point->state"},     {"v", velocity},          {"u", "point->input"},
                                     {"p", "point->parameter"}, {"c", "point->prepared"}, {"dq", "seed->state"},
                                     {"dv", seed_velocity},     {"du", "seed->input"},    {"dp", "seed->parameter"}};
  bool has_point = strstr(signature, "*point") != NULL;
  for (size_t i = 0; has_point && i < sizeof pointers / sizeof *pointers; i++)
    emit_pointer(file, text, pointers[i][0], pointers[i][1]);
  fprintf(file, "%s}\n\n", text);
  free(text);
  free(velocity);
  free(seed_velocity);
}
