/*
 * Constructors of simplified expressions. They fold constants, gather like terms, cancel common factors and apply sin^2
 * + cos^2 = 1 (J. Moses: Algebraic simplification: a guide for the perplexed, Communications of the ACM 14, 1971,
 * surveys such rules).
 *
 * Each result is in a local normal form: a node is coefficient * base with at most one numeric factor, which is the
 * left operand. Operands of sums and products are ordered by number. A numeric whole power of a power is one power,
 * and a product is regrouped by base if a factor cancels. The form is not canonical: equal expressions may be
 * different nodes, and rational.h decides more cases at a higher cost. A sum compares at most TERM_LIMIT terms of
 * each operand, a product at most FACTOR_LIMIT factors, so the cost of a node is bounded. Each combination of two
 * terms leaves one, so the recursion ends.
 */
#pragma once

#include "algebra/graph.h"

Node add(struct Graph *graph, Node left, Node right);

/* Returns left + right as one operation: like terms are not gathered, so that both sums remain shared. */
Node add_whole(struct Graph *graph, Node left, Node right);

Node subtract(struct Graph *graph, Node left, Node right);
Node multiply(struct Graph *graph, Node left, Node right);
Node divide(struct Graph *graph, Node left, Node right);
Node negate(struct Graph *graph, Node node);
Node scale(struct Graph *graph, double factor, Node node);
Node power(struct Graph *graph, Node base, Node exponent);

/* Returns base^exponent. */
Node power_number(struct Graph *graph, Node base, double exponent);

/* Returns a function of one or two operands; right is ignored for one. */
Node function(struct Graph *graph, enum Operation operation, Node left, Node right);

/* Returns an expression for positive if condition > 0, else for other. */
Node choose_node(struct Graph *graph, Node condition, Node positive, Node other);

/* Splits a node into coefficient * base; base has no numeric factor. A number has the base ONE. */
double coefficient_of(const struct Graph *graph, Node node, Node *base);

/* A factor base^exponent of a product. */
struct Factor {
  Node base;
  double exponent;
};

/* Most factors of a product, and terms of a sum, that are compared with others. */
enum { FACTOR_LIMIT = 12, TERM_LIMIT = 6 };

/* Finds the factors of a node without its coefficient, ascending by base. Returns their number, -1 if too many. */
int factors_of(const struct Graph *graph, Node node, struct Factor factors[FACTOR_LIMIT]);

/* Returns the product of factors, denominators last. */
Node product_of(struct Graph *graph, const struct Factor *factors, int count);

/* Splits a sum into at most limit terms; the last ones may be sums. Returns their number. */
int terms_of(const struct Graph *graph, Node node, Node *terms, int limit);
