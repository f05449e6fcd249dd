#include "read/tables/piecewise.h"

#include "algebra/simplify.h"
#include "read/names/pieces_of_functions.h"

static const char needed_by[] = "a table";

static Node way_from(struct Graph *graph, Node x, double knot) {
  return subtract(graph, x, graph_constant(graph, knot));
}

/* Returns a node that is positive for x >= knot. */
static Node from_knot_on(struct Scope *scope, Node x, double knot) {
  struct Graph *graph = scope->graph;
  Node before = negate(graph, branch_of(scope, way_from(graph, x, knot), needed_by, scope->table_line));
  return subtract(graph, ONE, function(graph, GUARD, before, ONE));
}

Node way_in(struct Scope *scope, Node x, double from, double to) {
  struct Graph *graph = scope->graph;
  Node is_behind = from_knot_on(scope, x, to), inside = way_from(graph, x, from);
  Node way = choose_node(graph, is_behind, graph_constant(graph, to - from), inside);
  return function(graph, GUARD, from_knot_on(scope, x, from), way);
}

Node way_before(struct Scope *scope, Node x, double start) {
  struct Graph *graph = scope->graph;
  Node way = way_from(graph, x, start);
  return function(graph, GUARD, negate(graph, branch_of(scope, way, needed_by, scope->table_line)), way);
}

Node way_behind(struct Scope *scope, Node x, double end) {
  struct Graph *graph = scope->graph;
  Node is_behind = from_knot_on(scope, x, end);
  return function(graph, GUARD, is_behind, way_from(graph, x, end));
}
