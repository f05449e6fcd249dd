/* Integrals by Gauss-Legendre quadrature: chooses the number of nodes and builds the sum. */
#pragma once

#include "algebra/quadrature.h"
#include "read/expressions/cursor.h"

/* An integral over the last dummy of the scope. */
struct Integral {
  Node value;
  size_t given; /* number of nodes that the author gave; 0 for none */
  char *text;   /* source text, for messages */
};

/*
 * Returns the weighted sum over the nodes, in which piecewise functions become modes. Warns if CHOICE_LIMIT nodes do
 * not suffice. Reports an integrand without a finite value.
 */
Node integrate(struct Parser *parser, const struct Integral *integral);
