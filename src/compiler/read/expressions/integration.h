/* Integrals by Gauss and Legendre: how many nodes they need, and the sum that stands for them. */
#pragma once

#include "algebra/quadrature.h"
#include "read/expressions/cursor.h"

/* Over the last dummy of the scope. */
struct Integral {
  Node value;
  size_t given; /* nodes that the author gave; 0 for none */
  char *text;   /* as it is written */
};

/* The sum over the nodes, by its pieces. Warns where no number of nodes is enough; reports an integrand without a finite value. */
Node integrate(struct Parser *parser, const struct Integral *integral);

/* A node with another in place of a symbol. */
Node replaced(struct Graph *graph, Node node, Node symbol, Node by);
