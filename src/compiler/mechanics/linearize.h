/* Linearisation about a point: x' = A (x - x0) + B (u - u0) + f(x0, u0). */
#pragma once

#include "mechanics/equations.h"

/* The matrices of a linear system; state order: coordinates, then velocities. Element (i, j) at i * columns + j. */
struct LinearSystem {
  size_t states, inputs;
  Node *a, *b; /* states x states, states x inputs */
  Node *c;     /* states: what remains at x = 0 and u = 0 */
};

/*
 * The equations linearised at model->point: accelerations affine in states and inputs, outputs and positions to first
 * order, energies to second; without the work of forces. Warns where the point is no equilibrium; NULL after reporting a
 * system that cannot be linearised there.
 */
struct Equations *linearize(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

/* The matrices of equations that are linear in states and inputs; NULL after reporting which acceleration is not. */
struct LinearSystem *linear_system_of(const struct Model *model, const struct Equations *equations,
                                      struct Diagnostics *diagnostics);

/* Prints A and B as formulas, then as numbers at the start values of the parameters. */
void linear_system_print(const struct Model *model, const struct LinearSystem *system);
