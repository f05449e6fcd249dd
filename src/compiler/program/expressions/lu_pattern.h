/* The sparse pattern in which implicit methods factor their matrices; see struct LuPattern of include/lagrangian.h. */
#pragma once

#include "mechanics/mass_matrix/elimination.h"
#include "program/expressions/expressions.h"

/* Returns the pattern; NULL if full matrices are cheaper. rows: of the velocities and the first-order states. */
struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates, size_t rows);
