/*
 * A backward data-flow analysis: each node passes its set of guard conditions to its operands, and a guard passes its
 * own condition to its operand. Repeats until nothing changes. Ends, as the sets only grow and hold at most
 * GUARD_CONDITION_LIMIT conditions. Nodes are numbered after their operands, so that only auxiliary nodes need a second
 * pass.
 */
#include "program/series/guard_conditions.h"

#include "base/memory.h"

static bool has_guards(const struct Graph *graph) {
  for (Node node = 0; node < graph->count; node++)
    if (graph->vertices[node].operation == GUARD) return true;
  return false;
}

static bool add_guard_condition(struct GuardConditions *guard_conditions, Node guard_condition) {
  if (guard_conditions->always) return false;
  for (size_t i = 0; i < guard_conditions->count; i++)
    if (guard_conditions->nodes[i] == guard_condition) return false;
  if (guard_conditions->count == GUARD_CONDITION_LIMIT) guard_conditions->always = true;
  else guard_conditions->nodes[guard_conditions->count++] = guard_condition;
  return true;
}

/* Adds the guard conditions of one node to those of another. Returns true if these have grown. */
static bool inherit(struct GuardConditions *to, const struct GuardConditions *from) {
  bool grown = from->always && !to->always;
  to->always |= from->always;
  for (size_t i = 0; i < from->count && !to->always; i++) grown |= add_guard_condition(to, from->nodes[i]);
  return grown;
}

/* Passes the guard conditions of a node to its operands. Returns true if any set has grown. */
static bool hand_on(const struct Graph *graph, const struct SeriesPlan *plan, struct GuardConditions *guard_conditions,
                    Node node) {
  const struct Vertex *vertex = &graph->vertices[node];
  int arity = operation_arity(vertex->operation);
  const struct GuardConditions *own = &guard_conditions[node];
  if (!own->always && own->count == 0) return false;
  bool grown = false;
  if (vertex->operation == GUARD) return add_guard_condition(&guard_conditions[vertex->right], vertex->left);
  if (arity > 0) grown |= inherit(&guard_conditions[vertex->left], own);
  if (arity > 1) grown |= inherit(&guard_conditions[vertex->right], own);
  if (plan->auxiliary[node] != ZERO && plan->auxiliary[node] != node)
    grown |= inherit(&guard_conditions[plan->auxiliary[node]], own);
  return grown;
}

struct GuardConditions *guard_conditions_of(const struct Graph *graph, const struct SeriesPlan *plan) {
  if (!has_guards(graph)) return NULL;
  struct GuardConditions *guard_conditions = allocate(graph->count, sizeof *guard_conditions);
  for (size_t i = 0; i < plan->root_count; i++) guard_conditions[plan->targets.nodes[i]].always = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (Node node = (Node)graph->count; node-- > 0;) grown |= hand_on(graph, plan, guard_conditions, node);
  }
  return guard_conditions;
}
