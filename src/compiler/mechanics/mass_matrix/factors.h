/* Symbolic factors K = L D L^T in the pattern of an elimination, without pivoting. */
#pragma once

#include "mechanics/mass_matrix/elimination.h"

/* Rows of a lower triangle, as struct Elimination has them: of a pattern that holds what L fills in. */
struct FactorPattern {
  size_t count;
  const size_t *start, *column;
};

/* The elements of L, and those of D on the diagonal, from those of K. */
Node *factors_create(struct Graph *graph, const struct FactorPattern *pattern, const Node *elements);

/* Solves K x = b in place. */
void factors_solve(struct Graph *graph, const struct FactorPattern *pattern, const Node *factors, Node *x);
