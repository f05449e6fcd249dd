/*
 * Quotients and logarithms of expressions that grow exponentially. 1/(1 + exp(u)) has a value for every u, but exp(u) overflows
 * beyond 709, and derivatives would be inf/inf there. For a sum g of terms with exp(u), or cosh(u) and sinh(u), a positive scale s
 * is taken, 1/(1 + exp(u)) or 1/cosh(u), so that s g is bounded: its terms are s exp(u) = 1/(1 + exp(-u)), s sinh(u) = tanh(u), ...
 * Then g^n = s^-n (s g)^n and log(g) = log(s g) - log(s), where s, its powers and its logarithm are functions of their own
 * (include/bounded_functions.h). Each of the functions below returns false where there is nothing to rewrite.
 */
#pragma once

#include "algebra/graph.h"

struct Factor;

/* base^n for a number n < 0. */
bool bounded_power(struct Graph *graph, Node base, double n, Node *result);

/* The natural logarithm of a node. */
bool bounded_logarithm(struct Graph *graph, Node node, Node *result);

/* A product of factors, in which what grows meets a scale. */
bool bounded_product(struct Graph *graph, const struct Factor *left, int left_count, const struct Factor *right,
                     int right_count, Node *result);

/* True if the operands of two logistic functions add up to 0, and so their values to 1. */
bool are_complements(const struct Graph *graph, Node left, Node right);
