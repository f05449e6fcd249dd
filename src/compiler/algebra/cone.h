/*
 * The cone of some targets: the nodes below them. Collecting it costs time in proportion to its size, not to that of
 * the graph. A cone is a workspace that is created once and used for many collections.
 */
#pragma once

#include "algebra/graph.h"

/* A set of nodes that is closed under operands, except where a visit ended. nodes has no duplicates. */
struct Cone {
  Node *nodes; /* ascending, so that operands come first */
  size_t count;
  uint32_t *index; /* of each node of the graph, its index in nodes; see cone_has() */
  size_t capacity;
  size_t work; /* steps of all sweeps so far, see graph_work() */
};

/* Returns an empty cone, for which cone_release() frees all memory. */
struct Cone *cone_create(void);
void cone_release(struct Cone *cone);

/* Collects the targets and all nodes below them. */
void cone_collect(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count);

/* Continuation of a collection after a member: to its operands, not below it, or not at all. */
enum Visit { VISIT_OPERANDS, VISIT_NOTHING_BELOW, VISIT_NO_MORE };

/* Collects as visit() decides, which sees each member once. False, with no members, if visit() ended the collection. */
bool cone_collect_part(struct Cone *cone, const struct Graph *graph, const Node *targets, size_t count,
                       enum Visit (*visit)(void *context, const struct Graph *graph, Node node), void *context);

/* True if the node is a member. */
bool cone_has(const struct Cone *cone, Node node);

/* Returns the index of a member in nodes. */
size_t cone_slot(const struct Cone *cone, Node node);
