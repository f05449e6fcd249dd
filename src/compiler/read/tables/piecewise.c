#include "read/tables/piecewise.h"

#include "algebra/simplify.h"
#include "names/piecewise_functions.h"

static const char needed_by[] = "a table";

static Node offset_from(struct Graph *graph, Node x, double knot) {
  return subtract(graph, x, graph_constant(graph, knot));
}

/* Returns a node that is positive for x >= knot. */
static Node is_at_or_above(struct Scope *scope, Node x, double knot) {
  struct Graph *graph = scope->graph;
  Node before = negate(graph, branch_of(scope, offset_from(graph, x, knot), needed_by, scope->table_line));
  return subtract(graph, ONE, function(graph, GUARD, before, ONE));
}

Node clamped_offset(struct Scope *scope, Node x, double from, double to) {
  struct Graph *graph = scope->graph;
  Node is_behind = is_at_or_above(scope, x, to), inside = offset_from(graph, x, from);
  Node way = choose_node(graph, is_behind, graph_constant(graph, to - from), inside);
  return function(graph, GUARD, is_at_or_above(scope, x, from), way);
}

Node offset_below(struct Scope *scope, Node x, double start) {
  struct Graph *graph = scope->graph;
  Node way = offset_from(graph, x, start);
  return function(graph, GUARD, negate(graph, branch_of(scope, way, needed_by, scope->table_line)), way);
}

Node offset_above(struct Scope *scope, Node x, double end) {
  struct Graph *graph = scope->graph;
  Node is_behind = is_at_or_above(scope, x, end);
  return function(graph, GUARD, is_behind, offset_from(graph, x, end));
}
