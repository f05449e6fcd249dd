/*
 * Choice of the shorter of two forms of expressions. Counts the operations of all nodes together: first those that vary
 * in time, then those of only parameters, which are evaluated once.
 */
#pragma once

#include "algebra/graph.h"

/* True if the nodes need fewer operations than the others. */
bool are_shorter(const struct Graph *graph, size_t count, const Node *nodes, const Node *others);

/* Replaces the nodes by the others if these need fewer operations. */
void take_shorter(const struct Graph *graph, size_t count, Node *nodes, const Node *others);

/* Replaces the nodes by reduced fractions (rational.h) if these need fewer operations. */
void shorten(struct Graph *graph, size_t count, Node *nodes);
