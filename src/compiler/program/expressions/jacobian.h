/* The Jacobian matrix of the motion, differentiated symbolically, element by element. */
#pragma once

#include "program/expressions/expressions.h"

/* Largest number of elements; a dense M makes each acceleration depend on all states. Bounds memory and code size. */
enum { JACOBIAN_LIMIT = 2500000 };

/* Returns the Jacobian; NULL if it would have more than JACOBIAN_LIMIT elements. */
struct JacobianExpressions *jacobian_create(struct Graph *graph, const struct Equations *equations);

/*
 * Returns the sparse pattern in which implicit methods factor their matrices, see struct LuPattern of
 * include/lagrangian.h; NULL if full matrices are cheaper. rows: of the velocities and the first-order states.
 */
struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates, size_t rows);
