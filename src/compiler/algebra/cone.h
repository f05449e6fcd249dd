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

/* Collects the targets and all that they need. */
void cone_collect(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count);

/* Where a collection goes from a member: on to its operands, not below it, or no further at all. */
enum Visit { VISIT_OPERANDS, VISIT_NOTHING_BELOW, VISIT_NO_MORE };

/* The same as far as visit() says, which sees each member once; false, and no member, where it ended the collection. */
bool cone_collect_part(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count,
                       enum Visit (*visit)(void *context, const struct Graph *graph, Node node), void *context);

/* Whether the node is a member. */
bool cone_has(const struct Cone *cone, Node node);

/* The place of a member in nodes. */
size_t cone_place(const struct Cone *cone, Node node);
