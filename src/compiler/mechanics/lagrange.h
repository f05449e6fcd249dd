/*
 * Derives the equations of motion from a general Lagrangian L(q, v, t) = K - U by Lagrange's equation,
 * d/dt (dL/dv_i) - dL/dq_i = Q_i (H. Goldstein: Classical Mechanics, chapter 1):
 *
 *  M a = Q + dL/dq - (d2L/dv dq) v - d2L/dv dt,     M = d2L/dv dv.
 *
 * The right side is Q less the bias forces, which are the left side of Lagrange's equation at a = 0. A reverse sweep
 * over the expression graph gives all momenta dL/dv, another one all dL/dq, and a forward sweep d/dt of all momenta. M
 * takes a reverse sweep for each momentum. For the bodies in K, the left side is that of inertial_forces.h, which is
 * shorter.
 */
#pragma once

#include "mechanics/equations.h"

/* Derives the equations of motion. Returns NULL after reporting errors, such as a coordinate without inertia. */
struct Equations *equations_derive(const struct Model *model, struct Diagnostics *diagnostics);
