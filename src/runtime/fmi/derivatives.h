/* Derivatives of variables. */
#pragma once

#include "instance/instance.h"

/* Computes value = d unknown / d known * seed. */
enum Status directional_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                   const unsigned *known, size_t known_count, const double *seed, double *value);

/*
 * Computes value = seed^T * d unknown / d known. A reverse sweep, in FMUs that have it, costs the same for any number
 * of knowns. Others take a directional derivative for each known.
 */
enum Status adjoint_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                               const unsigned *known, size_t known_count, const double *seed, double *value);

/* Computes first time derivatives of outputs, with those of the inputs; parameter constants must be current. */
enum Status derivatives_in_time(struct Instance *instance, const unsigned *reference, size_t count, double *value);

/* Computes time derivatives of outputs, each of its order. */
enum Status output_derivatives(struct Instance *instance, const unsigned *reference, size_t count, const int *order,
                               double *value);
