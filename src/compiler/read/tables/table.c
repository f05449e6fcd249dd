#include "read/tables/table.h"

#include "algebra/simplify.h"
#include "read/tables/piecewise.h"

const struct Table *table_named(const struct Scope *scope, const char *full_name) {
  return names_find(scope->tables, full_name);
}

static Node polynomial(struct Graph *graph, const struct Curve *curve, size_t i, Node s) {
  Node inner = scale(graph, curve->d[i], s);
  inner = add(graph, graph_constant(graph, curve->c[i]), inner);
  inner = multiply(graph, s, inner);
  inner = add(graph, graph_constant(graph, curve->b[i]), inner);
  return multiply(graph, s, inner);
}

/*
 * Returns the first value plus, for each interval, its cubic at the clamped coordinate. Each completed interval then
 * contributes its full increment.
 */
static Node curve_at(struct Scope *scope, const struct Curve *curve, bool is_constant_outside, Node x) {
  struct Graph *graph = scope->graph;
  size_t last = curve->count - 1;
  Node value = graph_constant(graph, curve->y[0]);
  if (!is_constant_outside) value = add(graph, value, scale(graph, curve->b[0], offset_below(scope, x, curve->x[0])));
  for (size_t i = 0; i < last; i++)
    value = add(graph, value, polynomial(graph, curve, i, clamped_offset(scope, x, curve->x[i], curve->x[i + 1])));
  if (is_constant_outside) return value;
  return add(graph, value, scale(graph, curve->b[last], offset_above(scope, x, curve->x[last])));
}

Node table_at(struct Scope *scope, const struct Table *table, const Node arguments[2], long line) {
  scope->table_line = line;
  return table->has_two_arguments
             ? surface_at(scope, &table->surface, table->is_constant_outside, arguments[0], arguments[1])
             : curve_at(scope, &table->curve, table->is_constant_outside, arguments[0]);
}
