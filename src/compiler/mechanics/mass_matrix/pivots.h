/* The factors M = L D L^T of the mass matrix: whether there are any, and the symbolic ones of small blocks. */
#pragma once

#include "mechanics/mass_matrix/inertia.h"

/* Numbers from 0.5 to 1.5, to find what an expression is in general. */
double next_random(uint64_t *seed);

/* Reports a coordinate without inertia, and a matrix that is singular everywhere or negative at the start values. */
bool pivots_check(const struct Model *model, const struct Inertia *inertia, struct Diagnostics *diagnostics);

/* Whether a tree has factors: not everywhere singular, and not negative at the start values. */
bool tree_has_factors(const struct Model *model, const struct ArticulatedTree *tree);

/* Factors the blocks that are unrolled, and appends their pivots. */
void pivots_factor(struct Graph *graph, struct Inertia *inertia);
