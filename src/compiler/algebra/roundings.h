/* How much of an expression's value is rounding. */
#ifndef ROUNDINGS_H
#define ROUNDINGS_H

#include "algebra/graph.h"

/*
 * What the roundings of all operations below the targets may make of their values, in units of the relative rounding
 * error, by a running error analysis to first order; symbols are taken as exact.
 */
void roundings_of(struct Graph *graph, const Node *targets, size_t count, Node *roundings);

#endif
