/* Linearization at an operating point: x' = A (x - x0) + B (u - u0) + f(x0, u0). */
#pragma once

#include "mechanics/equations.h"

/*
 * The matrices of a linear system x' = A x + B u + c. The state holds coordinates, velocities, then first-order states.
 * Element (i, j) has the index i * columns + j.
 */
struct LinearSystem {
  size_t states, inputs;
  Node *a, *b; /* states x states, states x inputs */
  Node *c;     /* [states] */
};

/*
 * Returns the equations linearized at model->point: accelerations affine in states and inputs, outputs and positions of
 * degree 1, energies of degree 2. The power of forces stays as it is. Warns if the point is no equilibrium. Returns
 * NULL after reporting a system that cannot be linearized there.
 */
struct Equations *linearize(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

/* Returns the matrices of linear equations; NULL after reporting the derivatives that are not linear. */
struct LinearSystem *linear_system_of(const struct Model *model, const struct Equations *equations,
                                      struct Diagnostics *diagnostics);

/* Prints A and B as formulas, then as numbers at the start values of the parameters. */
void linear_system_print(const struct Model *model, const struct LinearSystem *system);
