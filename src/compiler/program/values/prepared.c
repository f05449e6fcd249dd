#include "program/values/prepared.h"

#include "base/memory.h"

bool is_of_parameters(const struct Graph *graph, Node node) {
  return operation_arity(graph->vertices[node].operation) > 0 && graph_is_constant_in_time(graph, node);
}

/* Sets slot to 1 for the prepared values. */
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

struct Prepared *prepared_create(const struct Graph *graph, struct NodeList targets) {
  struct Prepared *prepared = allocate(1, sizeof *prepared);
  struct NodeList nodes = {0};
  prepared->slot = allocate(graph->count, sizeof *prepared->slot);
  mark(graph, targets, prepared->slot);
  for (Node node = 0; node < graph->count; node++) {
    if (prepared->slot[node] == 0) continue;
    append_node(&nodes, node);
    prepared->slot[node] = nodes.count;
  }
  prepared->nodes = nodes.nodes;
  prepared->count = nodes.count;
  return prepared;
}
