/* Expressions brought to one fraction of polynomials with common factors cancelled: readable and well conditioned. */
#pragma once

#include "algebra/graph.h"

/*
 * The same value as a fraction in lowest terms, as far as division finds common factors. Where the expression is too
 * large for that, it is returned unchanged.
 */
Node simplify_fraction(struct Graph *graph, Node node);

/*
 * Solves matrix * solution = right side by elimination in fractions, so that rational coefficients stay exact.
 * matrix: n x n with nonzero leading minors; right and solution: n x columns; all by rows. False where the
 * expressions are too large for fractions or the matrix is singular; solution is then undefined.
 */
bool solve_fractions(struct Graph *graph, size_t n, const Node *matrix, size_t columns, const Node *right,
                     Node *solution);
