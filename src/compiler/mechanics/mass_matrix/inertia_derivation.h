/* Derivation of the mass matrix, its blocks and its checks. */
#pragma once

#include "mechanics/mass_matrix/constraint_block.h"
#include "mechanics/mass_matrix/inertia.h"

/*
 * Largest block of M that is solved by straight-line code. A numerical factorization of larger ones takes fewer
 * operations: the Taylor series of symbolic factors would be longer than all others of the system.
 */
enum { UNROLL_LIMIT = 2 };

/*
 * Returns K from the momenta dL/dv of all coordinates; regularization is energy_of_regularization(). Returns NULL after
 * reporting a coordinate without inertia, or an M that is singular everywhere, or not positive definite at the start
 * values.
 */
struct Inertia *inertia_derive(const struct Model *model, const Node *momentum, Node regularization,
                               const struct ConstraintBlock *constraint_block, struct Diagnostics *diagnostics);
