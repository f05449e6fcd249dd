/*
 * Lagrange's equation, d/dt (dL/dv_i) - dL/dq_i = Q_i, for a general L(q, v, t) = K - U:
 *
 *   M a = Q + dL/dq - (d2L/dv dq) v - d2L/dv dt,     M = d2L/dv dv
 *
 * For the bodies' share of K the left side is that of inertial_forces.h.
 */
#pragma once

#include "mechanics/equations.h"

/* Derives the equations of motion; NULL after reporting errors (a coordinate without inertia, ...). */
struct Equations *equations_derive(const struct Model *model, struct Diagnostics *diagnostics);
