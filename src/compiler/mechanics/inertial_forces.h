/*
 * d/dt (dK/dv_i) - dK/dq_i of the bodies' share of K, as d'Alembert's sum over what has an inertia:
 *
 *   sum m (d2r/dt2) . dr/dq_i                              for particles and planar bodies
 *   sum m (v' + omega x v) . dv/dv_i + (I omega' + omega x I omega) . d omega/dv_i      for bodies in frames
 *
 * with the velocities v and omega along the frame's axes, and x' for d/dt of components. Lagrange's general form makes
 * terms that only cancel each other, which these leave out.
 */
#pragma once

#include "model/model.h"

/*
 * Of the symbols of the kind with these time derivatives (seeds): COORDINATE, or DISPLACEMENT or INPUT, where the symbol of a
 * rate follows its own, and its element means nothing.
 */
Node *inertial_forces(const struct Model *model, const Node *seeds, enum SymbolKind kind, size_t count);

/* The kinetic energy of what has an inertia without energy: 0 on the motion, but not its second derivatives. */
Node energy_of_stillness(const struct Model *model);
