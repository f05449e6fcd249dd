/* The mass matrix of a model, with its blocks found and checked. */
#pragma once

#include "mechanics/mass_matrix/border.h"
#include "mechanics/mass_matrix/inertia.h"

/*
 * Blocks of M up to this size become straight-line code. Larger ones take fewer operations where their numbers are
 * factored: the Taylor series of a symbolic factorization alone would be longer than all others.
 */
enum { UNROLL_LIMIT = 2 };

/*
 * K from the momenta dL/dv of all coordinates; stillness: energy_of_stillness(). Reports a coordinate without inertia and an M that is
 * singular everywhere or not positive at the start values; NULL then.
 */
struct Inertia *inertia_derive(const struct Model *model, const Node *momentum, Node stillness,
                               const struct Border *border, struct Diagnostics *diagnostics);
