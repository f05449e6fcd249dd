/*
 * Takes the shorter one of two forms of expressions, by the operations that they need together: those that change in
 * motion count first, those of parameters alone are computed once for all.
 */
#pragma once

#include "algebra/graph.h"

/* Whether the nodes need fewer operations than the others. */
bool are_shorter(const struct Graph *graph, size_t count, const Node *nodes, const Node *others);

/* Replaces the nodes by the others where these need fewer operations. */
void take_shorter(const struct Graph *graph, size_t count, Node *nodes, const Node *others);

/* Takes the nodes multiplied out, as fractions in lowest terms, where that makes them shorter. */
void shorten(struct Graph *graph, size_t count, Node *nodes);
