/* Expressions brought to one fraction of polynomials with common factors cancelled: readable and well conditioned. */
#ifndef RATIONAL_H
#define RATIONAL_H

#include "graph.h"

/*
 * The same value as a fraction in lowest terms, as far as division finds common factors. Where the expression is too
 * large for that, it is returned unchanged.
 */
Node simplify_fraction(struct Graph *graph, Node node);

#endif
