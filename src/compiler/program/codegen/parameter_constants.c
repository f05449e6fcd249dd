#include "program/codegen/parameter_constants.h"

#include "base/memory.h"

bool is_of_parameters(const struct Graph *graph, Node node) {
  return operation_arity(graph->vertices[node].operation) > 0 && graph_is_constant_in_time(graph, node);
}

/* Sets slot to 1 for the parameter constants. */
static void mark(const struct Graph *graph, struct NodeList targets, size_t *slot) {
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, targets.nodes, targets.count, needed);
  for (size_t i = 0; i < targets.count; i++)
    if (is_of_parameters(graph, targets.nodes[i])) slot[targets.nodes[i]] = 1;
  for (Node node = 0; node < graph->count; node++) {
    const struct Vertex *vertex = &graph->vertices[node];
    int arity = operation_arity(vertex->operation);
    if (!needed[node] || arity == 0 || is_of_parameters(graph, node)) continue;
    if (is_of_parameters(graph, vertex->left)) slot[vertex->left] = 1;
    if (arity == 2 && is_of_parameters(graph, vertex->right)) slot[vertex->right] = 1;
  }
}

struct ParameterConstants *parameter_constants_create(const struct Graph *graph, struct NodeList targets) {
  struct ParameterConstants *parameter_constants = allocate(1, sizeof *parameter_constants);
  struct NodeList nodes = {0};
  parameter_constants->slot = allocate(graph->count, sizeof *parameter_constants->slot);
  mark(graph, targets, parameter_constants->slot);
  for (Node node = 0; node < graph->count; node++) {
    if (parameter_constants->slot[node] == 0) continue;
    append_node(&nodes, node);
    parameter_constants->slot[node] = nodes.count;
  }
  parameter_constants->nodes = nodes.nodes;
  parameter_constants->count = nodes.count;
  return parameter_constants;
}
