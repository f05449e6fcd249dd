/*
 * The nodes that some targets need, found at a cost that grows with their number and not with that of the graph's. A
 * cone is a workspace: it is created once and collects again and again.
 */
#pragma once

#include "algebra/graph.h"

struct Cone {
  Node *nodes; /* ascending, operands before what they are operands of */
  size_t count;
  size_t *place; /* for each node of the graph; see cone_place() */
  size_t capacity;
  size_t work; /* steps of all sweeps so far; see graph_work() */
};

struct Cone *cone_create(void);

/*
 * Collects the targets and all that they need; below nodes for which stops() is true it does not look, and they are
 * members. stops may be NULL.
 */
void cone_collect(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count,
                  bool (*stops)(const struct Graph *graph, Node node));

/* Whether the node is a member. */
bool cone_has(const struct Cone *cone, Node node);

/* The place of a member in nodes. */
size_t cone_place(const struct Cone *cone, Node node);
