/*
 * Quotients and logarithms of expressions that grow exponentially. 1/(1 + exp(u)) has a value for every u, but exp(u)
 * overflows beyond 709, and derivatives would be inf/inf there. A sum g of terms with exp(u), or with cosh(u) and
 * sinh(u), gets a positive scale s, 1/(1 + exp(u)) or 1/cosh(u), such that s g is bounded: its terms are s exp(u) =
 * 1/(1 + exp(-u)), s sinh(u) = tanh(u) and so on. Then g^n = s^-n (s g)^n and log(g) = log(s g) - log(s), where s, its
 * powers and its logarithm are functions of their own (include/bounded_functions.h). Each function below returns false
 * if there is nothing to rewrite.
 */
#pragma once

#include "algebra/graph.h"

struct Factor;

/* Rewrites base^n for a number n < 0. */
bool bounded_power(struct Graph *graph, Node base, double n, Node *result);

/* Rewrites the natural logarithm of a node. */
bool bounded_logarithm(struct Graph *graph, Node node, Node *result);

/*
 * Caps the only growing exponential in the argument of a function that is constant to rounding for large arguments.
 */
bool bounded_argument(struct Graph *graph, Node argument, Node *result);

/* Rewrites a product in which a growing factor cancels against a scale. */
bool bounded_product(struct Graph *graph, const struct Factor *left, int left_count, const struct Factor *right,
                     int right_count, Node *result);

/* True if the operands of two logistic functions add up to 0, and so their values to 1. */
bool are_complements(const struct Graph *graph, Node left, Node right);
