/* The Jacobian matrix of the motion, from gradients of the equations one by one. */
#ifndef JACOBIAN_H
#define JACOBIAN_H

#include "program/expressions.h"

/* Free with jacobian_free(). */
struct JacobianExpressions *jacobian_create(struct Graph *graph, const struct Equations *equations);
void jacobian_free(struct JacobianExpressions *jacobian);

#endif
