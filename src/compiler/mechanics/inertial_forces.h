/*
 * Inertial forces d/dt (dK/dv_i) - dK/dq_i of the bodies, in d'Alembert's form with partial velocities (T. R. Kane,
 * D. A. Levinson: Dynamics: Theory and Applications, 1985):
 *
 *  sum m (d2r/dt2) . dr/dq_i                              for particles and planar bodies
 *  sum m (v' + omega x v) . dv/dv_i + (I omega' + omega x I omega) . d omega/dv_i      for bodies in frames
 *
 * v and omega have components along the frame's axes; v' is d/dt of the components. The general form of Lagrange's
 * equation has more terms, which cancel each other.
 */
#pragma once

#include "model/model.h"

/*
 * Returns the inertial forces along the symbols of a kind; seeds are the time derivatives of all symbols. The kind is
 * COORDINATE, or DISPLACEMENT or INPUT, where each symbol is followed by its rate: elements of rates have no meaning.
 */
Node *inertial_forces(const struct Model *model, const Node *seeds, enum SymbolKind kind, size_t count);

/* Returns the kinetic energy of the regularization: 0 on the motion, but with nonzero second derivatives. */
Node energy_of_regularization(const struct Model *model);
