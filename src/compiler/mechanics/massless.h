/*
 * Regularization of a singular mass matrix. Coordinates without inertia, as of massless links, make M singular, while
 * K = (M J^T; J 0) is regular if constraints determine their motion. M + J_h^T m J_h, with inertias m for some
 * constraints h, gives the same solutions (augmented Lagrangian) and may be regular.
 *
 * The constraints h are found in numbers, at random values of all symbols, where an expression that does not vanish
 * identically is nonzero with probability 1. While a component of M + J_h^T J_h has a null vector z, all constraints
 * with J z != 0 join h. Each round adds a constraint or ends; it costs n^3 / 6 multiplications for a component of n
 * coordinates.
 */
#pragma once

#include "model/model.h"

/* Regularizes M, if constraints determine the motions without inertia. */
void regularize_massless_coordinates(struct Model *model);
