/* The structure of the mass matrix: is it regular, which blocks has it, and L D L^T of the small ones. */
#ifndef MASS_MATRIX_H
#define MASS_MATRIX_H

#include "mechanics/lagrange.h"

/* Reports a coordinate without inertia and a matrix that is singular everywhere. True where it is regular. */
bool mass_matrix_check(const struct Model *model, const struct Equations *equations, struct Diagnostics *diagnostics);

/* Finds the independent blocks, factors the small ones symbolically and solves them for the accelerations. */
void mass_matrix_factor(struct Model *model, struct Equations *equations);

#endif
