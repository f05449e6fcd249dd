/* Which computed variables one routine computes together. */
#pragma once

#include "program/expressions/expressions.h"

struct ResultGroups {
  size_t count;           /* of results */
  size_t *leader, *place; /* of each: the first of those that are computed together, and its place among them */
};

/*
 * The components of one thing, such as a point's x, y and z, are a group. So are things that need much and the same, as the
 * bodies at the end of a chain do, as long as none costs half as much again as by itself: the routines of a chain are
 * then as long together as the chain, and not as its square.
 */
struct ResultGroups result_groups_of(const struct Expressions *expressions);

/* Each by itself. */
struct ResultGroups groups_of_one(size_t count);

/* The results of the group of this leader; a new list. */
struct NodeList group_members(const struct ResultGroups *groups, const Node *result, size_t leader);
