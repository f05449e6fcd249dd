/* Groups of computed variables: one function computes all variables of a group together. */
#pragma once

#include "program/expressions/expressions.h"

/* The groups of all results. The leader of a group is its first result, with the index 0 in it. */
struct ResultGroups {
  size_t count;          /* number of results */
  size_t *leader, *slot; /* of each result: the first one of its group, and its index in the group */
};

/*
 * Groups the components of one object, such as a point's x, y and z. Objects join a group if they need many and
 * mostly the same nodes, as the bodies at the end of a chain do. The group needs at most 1.5 times the nodes of
 * each object alone. The code of a chain is then as long as the chain, not as its square. Greedy: each object joins
 * the first of the open groups that fits; O(objects * nodes).
 */
struct ResultGroups result_groups_of(const struct Expressions *expressions);

/* Returns groups of one result each. */
struct ResultGroups groups_of_one(size_t count);

/* Returns a new list of the results in the group of this leader. */
struct NodeList group_members(const struct ResultGroups *groups, const Node *result, size_t leader);
