#include "algebra/shorten.h"

#include <stdlib.h>

#include "algebra/cone.h"
#include "algebra/rational.h"
#include "memory.h"

/* How many operations the nodes take together. */
static size_t operations_of(const struct Graph *graph, const Node *nodes, size_t count) {
  const struct Cone *cone = graph->cone;
  cone_collect(graph->cone, graph, nodes, count, NULL);
  size_t operations = 0;
  for (size_t place = 0; place < cone->count; place++)
    operations += operation_arity(graph->vertices[cone->nodes[place]].operation) > 0;
  return operations;
}

void take_shorter(const struct Graph *graph, size_t count, Node *nodes, const Node *others) {
  if (operations_of(graph, others, count) >= operations_of(graph, nodes, count)) return;
  for (size_t i = 0; i < count; i++) nodes[i] = others[i];
}

void shorten(struct Graph *graph, size_t count, Node *nodes) {
  Node *others = allocate(count, sizeof *others);
  for (size_t i = 0; i < count; i++) others[i] = simplify_fraction(graph, nodes[i]);
  take_shorter(graph, count, nodes, others);
  free(others);
}
