/* The pattern in which implicit methods factor their matrices: include/lagrangian.h, struct LuPattern. */
#pragma once

#include "mechanics/mass_matrix/elimination.h"
#include "program/expressions/expressions.h"

/* For so many coordinates, and rows of velocities and states behind them; NULL where full matrices are cheaper. */
struct Elimination *lu_pattern_create(const struct Graph *graph, const struct JacobianExpressions *jacobian,
                                      size_t coordinates, size_t rows);
