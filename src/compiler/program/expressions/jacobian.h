/* The Jacobian matrix of the motion, from gradients of the equations one by one. */
#pragma once

#include "program/expressions/expressions.h"

/* More elements than this are refused: where M couples all coordinates, each depends on all others. */
enum { JACOBIAN_LIMIT = 2500000 };

/* NULL where there are more than JACOBIAN_LIMIT elements. */
struct JacobianExpressions *jacobian_create(struct Graph *graph, const struct Equations *equations);
