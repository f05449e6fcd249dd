/*
 * Expressions as fractions of two polynomials (K. O. Geddes, S. R. Czapor, G. Labahn: Algorithms for Computer Algebra,
 * 1992, chapter 3). Symbols, functions and fractional powers are the indeterminates. A fraction is reduced by common
 * monomials, and by the denominator or numerator if one divides the other; there is no general greatest common divisor.
 * Coefficients become whole numbers if possible. Reduced fractions are shorter and better conditioned. Expressions with
 * more than ATOM_LIMIT indeterminates, or MONOMIAL_LIMIT terms, are left as they are, which bounds the cost.
 */
#pragma once

#include "algebra/graph.h"

/* Returns the node as a reduced fraction; the node itself if it is too large. */
Node simplify_fraction(struct Graph *graph, Node node);

/*
 * Solves matrix * solution = right in fractions, by Gauss-Jordan elimination, so that rational coefficients stay exact.
 * matrix is n x n with nonzero leading minors; right and solution are n x columns; all by rows. False if the
 * expressions are too large or the matrix is singular; solution is then undefined.
 */
bool solve_fractions(struct Graph *graph, size_t n, const Node *matrix, size_t columns, const Node *right,
                     Node *solution);
