#include "read/pieces.h"

#include "algebra/simplify.h"

Node way_in(struct Graph *graph, Node x, double from, double to) {
  Node way = way_behind(graph, x, from);
  return function(graph, MINIMUM, graph_constant(graph, to - from), way);
}

Node way_before(struct Graph *graph, Node x, double start) {
  return function(graph, MINIMUM, ZERO, subtract(graph, x, graph_constant(graph, start)));
}

Node way_behind(struct Graph *graph, Node x, double end) {
  return function(graph, MAXIMUM, subtract(graph, x, graph_constant(graph, end)), ZERO);
}
