/*
 * Regularity of the mass matrix, and symbolic factors M = L D L^T of small blocks.
 *
 * M is regular in general if its numerical factors are so at one of eight random points. A determinant that does
 * not vanish identically vanishes there with probability 0.
 */
#pragma once

#include "mechanics/mass_matrix/inertia.h"

/* Returns pseudorandom numbers in [0.5, 1.5), by a linear congruential generator. */
double next_random(uint64_t *seed);

/* False after reporting a coordinate without inertia, an M singular everywhere, or a negative pivot at the start. */
bool pivots_check(const struct Model *model, const struct Inertia *inertia, struct Diagnostics *diagnostics);

/* True if a tree has factors: it is not singular everywhere, and has no negative pivot at the start values. */
bool tree_has_factors(const struct Model *model, const struct ArticulatedTree *tree);

/* Factors the unrolled blocks, and collects their pivots. */
void pivots_factor(struct Graph *graph, struct Inertia *inertia);
