/*
 * Lagrange's equation, d/dt (dL/dv_i) - dL/dq_i = Q_i, for a general L(q, v, t) = K - U:
 *
 *   M a = Q + dL/dq - (d2L/dv dq) v - d2L/dv dt,     M = d2L/dv dv
 *
 * For the bodies' share of K the left side is the same as d'Alembert's sum m (d2r/dt2) . dr/dq_i. This form is used
 * for it, because the general one makes terms that only cancel each other.
 */
#ifndef LAGRANGE_H
#define LAGRANGE_H

#include "mechanics/inertia.h"

struct Equations {
  size_t count;       /* coordinates */
  bool explicit_form; /* accelerations are given as such (linearised systems), there is no mass matrix */
  struct Inertia *inertia;
  Node *right_side;               /* M a = right_side */
  Node *residual;                 /* M a - right_side with the acceleration symbols for a */
  Node *acceleration;             /* expressions in unrolled blocks, the acceleration symbols in others */
  Node power;                     /* of the non-conservative forces: sum Q_i v_i, and F . dr/dt of Cartesian ones */
  Node kinetic, potential, total; /* energies, see energies.h */
};

/* Derives the equations of motion; reports errors (a coordinate without inertia, ...) to diagnostics. */
struct Equations *equations_derive(struct Model *model, struct Diagnostics *diagnostics);
/* Reports coefficients that are not finite: of sums and products too large for numbers, and of a point at a pole. */
void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

void equations_free(struct Equations *equations);

/* Whether the coordinate belongs to a block of M that is solved at run time, by ldlt.h. */
bool is_looped(const struct Equations *equations, size_t coordinate);

/* Whether there is such a block. */
bool has_loops(const struct Equations *equations);

#endif
