/*
 * A backward data-flow analysis: each node passes its set of guard conditions to its operands, and a gate passes its
 * own condition to its operand. Repeats until nothing changes. Ends, as the sets only grow and hold at most
 * OPENER_LIMIT conditions; nodes are numbered after their operands, so that auxiliary nodes alone need a second pass.
 */
#include "program/series/openers.h"

#include "base/memory.h"

static bool has_gates(const struct Graph *graph) {
  for (Node node = 0; node < graph->count; node++)
    if (graph->vertices[node].operation == GATE) return true;
  return false;
}

static bool add_opener(struct Openers *openers, Node opener) {
  if (openers->always) return false;
  for (size_t i = 0; i < openers->count; i++)
    if (openers->nodes[i] == opener) return false;
  if (openers->count == OPENER_LIMIT) openers->always = true;
  else openers->nodes[openers->count++] = opener;
  return true;
}

/* Adds the guard conditions of one node to those of another. Returns true if these have grown. */
static bool inherit(struct Openers *to, const struct Openers *from) {
  bool grown = from->always && !to->always;
  to->always |= from->always;
  for (size_t i = 0; i < from->count && !to->always; i++) grown |= add_opener(to, from->nodes[i]);
  return grown;
}

/* Passes the guard conditions of a node to its operands. Returns true if any set has grown. */
static bool hand_on(const struct Graph *graph, const struct SeriesPlan *plan, struct Openers *openers, Node node) {
  const struct Vertex *vertex = &graph->vertices[node];
  int arity = operation_arity(vertex->operation);
  const struct Openers *own = &openers[node];
  if (!own->always && own->count == 0) return false;
  bool grown = false;
  if (vertex->operation == GATE) return add_opener(&openers[vertex->right], vertex->left);
  if (arity > 0) grown |= inherit(&openers[vertex->left], own);
  if (arity > 1) grown |= inherit(&openers[vertex->right], own);
  if (plan->auxiliary[node] != ZERO && plan->auxiliary[node] != node)
    grown |= inherit(&openers[plan->auxiliary[node]], own);
  return grown;
}

struct Openers *openers_of(const struct Graph *graph, const struct SeriesPlan *plan) {
  if (!has_gates(graph)) return NULL;
  struct Openers *openers = allocate(graph->count, sizeof *openers);
  for (size_t i = 0; i < plan->root_count; i++) openers[plan->targets.nodes[i]].always = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (Node node = (Node)graph->count; node-- > 0;) grown |= hand_on(graph, plan, openers, node);
  }
  return openers;
}
