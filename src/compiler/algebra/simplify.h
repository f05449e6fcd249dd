/*
 * The algebra of the expression graph. These constructors fold constants, gather like terms, cancel common factors
 * and apply sin^2 + cos^2 = 1, looking only at a bounded number of neighbours, so that building stays linear.
 */
#pragma once

#include "algebra/graph.h"

Node add(struct Graph *graph, Node left, Node right);

/* left + right in one operation: sums stay as they are, and as others need them, where gathering like terms takes them apart. */
Node add_whole(struct Graph *graph, Node left, Node right);

Node subtract(struct Graph *graph, Node left, Node right);
Node multiply(struct Graph *graph, Node left, Node right);
Node divide(struct Graph *graph, Node left, Node right);
Node negate(struct Graph *graph, Node node);
Node scale(struct Graph *graph, double factor, Node node);
Node power(struct Graph *graph, Node base, Node exponent);

/* base to a number */
Node power_number(struct Graph *graph, Node base, double exponent);

/* A function of one or two operands; right is ignored for one. */
Node function(struct Graph *graph, enum Operation operation, Node left, Node right);

/* The first node where the condition is positive, else the other. */
Node choose_node(struct Graph *graph, Node condition, Node positive, Node other);

/* node = coefficient * base with base free of a numeric factor; a number has the base ONE. */
double coefficient_of(const struct Graph *graph, Node node, Node *base);

/* A factor base^exponent of a product. */
struct Factor {
  Node base;
  double exponent;
};

enum { FACTOR_LIMIT = 12, TERM_LIMIT = 6 };

/*
 * The factors of a node without its coefficient, ascending by base, at most FACTOR_LIMIT of them.
 * Returns their number, or -1 where there are more.
 */
int factors_of(const struct Graph *graph, Node node, struct Factor factors[FACTOR_LIMIT]);

/* The product of factors, denominators last. */
Node product_of(struct Graph *graph, const struct Factor *factors, int count);

/* Splits a sum into at most limit terms, which may be sums themselves. Returns their number. */
int terms_of(const struct Graph *graph, Node node, Node *terms, int limit);
