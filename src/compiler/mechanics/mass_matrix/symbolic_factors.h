/*
 * Symbolic factors K = L D L^T in the pattern of an elimination, without pivoting. The expressions grow with each
 * elimination, so blocks larger than UNROLL_LIMIT are factored numerically, by ldlt.h and saddle.h.
 */
#pragma once

#include "mechanics/mass_matrix/elimination.h"

/* Rows of a lower triangle, as in struct Elimination; the pattern includes the fill-in. */
struct FactorPattern {
  size_t count;
  const size_t *start, *column;
};

/* Returns the elements of L, and those of D on the diagonal, from those of K. */
Node *factors_create(struct Graph *graph, const struct FactorPattern *pattern, const Node *elements);

/* Solves K x = b in place. */
void factors_solve(struct Graph *graph, const struct FactorPattern *pattern, const Node *factors, Node *x);
