#include "program/expressions/series_plan.h"

#include "algebra/differentiate.h"
#include "algebra/functions.h"
#include "base/memory.h"

static Node auxiliary_of(struct Graph *graph, Node node) {
  const struct Function *row = &functions[graph->vertices[node].operation];
  return row->auxiliary != NULL ? row->auxiliary(graph, node) : ZERO;
}

static void append_equations(struct SeriesPlan *plan, const struct Equations *equations) {
  size_t n = equations->explicit_form ? equations->count : row_count(equations);
  for (size_t i = 0; i < n; i++) {
    if (!is_looped(equations, i)) {
      if (i < equations->count) append_node(&plan->targets, equations->acceleration[i]);
      continue;
    }
    append_node(&plan->targets, equations->right_side[i]);
    const struct InertiaBlock *block = inertia_block_of(equations->inertia, i);
    size_t row = equations->inertia->index_in_block[i];
    for (size_t k = block->start[row]; k < block->start[row + 1]; k++) append_node(&plan->targets, block->mass[k]);
    for (size_t k = 0; k < block->force_count; k++)
      append_node(&plan->targets, block->nonsymmetric[k * block->count + row]);
  }
}

/* Returns the time derivative of a node that is linear in time and independent of the state; ZERO for other nodes. */
static Node slope_of(struct Graph *graph, Node node, Node time) {
  if ((graph->vertices[node].kinds & ~(1u << PARAMETER | 1u << MODE)) != 1u << TIME) return ZERO;
  Node slope = derivative_by(graph, node, time);
  return graph_is_constant_in_time(graph, slope) ? slope : ZERO;
}

/* Finds the slopes of the operands of functions with the recurrence INTEGRAL, and adds them to the targets. */
static void append_slopes(struct SeriesPlan *plan, struct Graph *graph) {
  Node time = ZERO;
  for (size_t i = 0; i < graph->symbol_count; i++)
    if (graph->symbols[i].kind == TIME) time = graph->symbols[i].node;
  size_t size = graph->count;
  bool *needed = allocate(size, sizeof *needed);
  Node *slope = allocate(size, sizeof *slope);
  graph_mark(graph, plan->targets.nodes, plan->targets.count, needed);
  for (Node node = 0; node < size; node++) {
    Node operand = graph->vertices[node].left;
    if (!needed[node] || functions[graph->vertices[node].operation].recurrence != INTEGRAL) continue;
    if (slope[operand] == ZERO) slope[operand] = slope_of(graph, operand, time);
    if (slope[operand] != ZERO) append_node(&plan->targets, slope[operand]);
  }
  plan->slope = reallocate(slope, graph->count, sizeof *slope);
  for (size_t i = size; i < graph->count; i++) plan->slope[i] = ZERO;
}

/*
 * Adds the auxiliary nodes of all needed nodes, and those of the added ones, until none is new. Ends, as auxiliary
 * nodes of auxiliary nodes lead back: sin(x) needs cos(x), which needs sin(x).
 */
static void close(struct SeriesPlan *plan, struct Graph *graph) {
  bool *visited = NULL;
  size_t known = 0;
  for (bool grown = true; grown && graph_limit(graph) == NULL;) {
    size_t size = graph->count;
    bool *needed = allocate(size, sizeof *needed);
    visited = reallocate(visited, size, sizeof *visited);
    for (; known < size; known++) visited[known] = false;
    graph_mark(graph, plan->targets.nodes, plan->targets.count, needed);
    grown = false;
    for (Node node = 0; node < size; node++) {
      if (!needed[node] || visited[node] || graph_is_constant_in_time(graph, node)) continue;
      visited[node] = grown = true;
      Node auxiliary = auxiliary_of(graph, node);
      bool is_known = auxiliary == ZERO || auxiliary == node || auxiliary == graph->vertices[node].left;
      if (!is_known) append_node(&plan->targets, auxiliary);
    }
  }
}

/* Completes a plan whose targets are given. */
static struct SeriesPlan *finish(struct SeriesPlan *plan, struct Graph *graph) {
  plan->root_count = plan->targets.count;
  close(plan, graph);
  append_slopes(plan, graph);
  size_t size = graph->count;
  bool *needed = allocate(size, sizeof *needed);
  graph_mark(graph, plan->targets.nodes, plan->targets.count, needed);
  plan->auxiliary = allocate(size, sizeof *plan->auxiliary);
  for (Node node = 0; node < size; node++)
    if (needed[node] && !graph_is_constant_in_time(graph, node)) plan->auxiliary[node] = auxiliary_of(graph, node);
  return plan;
}

struct SeriesPlan *series_plan_of_motion(struct Graph *graph, const struct Equations *equations) {
  struct SeriesPlan *plan = allocate(1, sizeof *plan);
  append_equations(plan, equations);
  append_nodes(&plan->targets, equations->rates.nodes, equations->rates.count);
  return finish(plan, graph);
}

struct SeriesPlan *series_plan_of_outputs(struct Graph *graph, const Node *outputs, size_t count) {
  struct SeriesPlan *plan = allocate(1, sizeof *plan);
  append_nodes(&plan->targets, outputs, count);
  return finish(plan, graph);
}
