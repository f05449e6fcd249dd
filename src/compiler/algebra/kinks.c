#include "algebra/kinks.h"

#include "algebra/functions.h"
#include "base/memory.h"

/*
 * The name of the kink that a node makes, NULL for none. An inverse function of its own function is piecewise linear:
 * its series goes on where it turns.
 */
static const char *kink_without_series(const struct Graph *graph, Node node) {
  const struct Vertex *vertex = &graph->vertices[node];
  const struct Function *row = &functions[vertex->operation];
  if (row->fold_name == NULL) return NULL;
  enum Operation inner = graph->vertices[vertex->left].operation;
  bool folds = operation_arity(inner) == 1 && (inner == row->folded[0] || inner == row->folded[1]);
  return folds ? row->fold_name : NULL;
}

static const char *kink_at(const struct Graph *graph, Node node) {
  const struct Function *row = &functions[graph->vertices[node].operation];
  return row->has_pieces ? row->name : kink_without_series(graph, node);
}

/* What `at` says of the first node below these that changes in time and of which it says something. */
static const char *find_kink(const struct Graph *graph, const Node *nodes, size_t count,
                             const char *(*at)(const struct Graph *, Node)) {
  bool *needed = allocate(graph->count, sizeof *needed);
  const char *kink = NULL;
  graph_mark(graph, nodes, count, needed);
  for (Node node = 0; node < graph->count && kink == NULL; node++)
    if (needed[node] && !graph_is_constant_in_time(graph, node)) kink = at(graph, node);
  release(needed);
  return kink;
}

const char *kink_of(const struct Graph *graph, const Node *nodes, size_t count) {
  return find_kink(graph, nodes, count, kink_at);
}

const char *kink_without_series_of(const struct Graph *graph, const Node *nodes, size_t count) {
  return find_kink(graph, nodes, count, kink_without_series);
}
