#include "algebra/kinks.h"

#include "algebra/functions.h"
#include "base/memory.h"

/*
 * Returns the name of the kink of an inverse function of its own function, such as asin(sin(x)); NULL for none. This is
 * piecewise linear, and the series of a piece, a straight line, shows no sign of the kink at its end.
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

/* Returns the result of `at` for the first node below these that varies in time and has one; NULL for none. */
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
