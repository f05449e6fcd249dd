/* Derivatives of variables. */
#ifndef DERIVATIVES_H
#define DERIVATIVES_H

#include "instance/instance.h"

/* value = d unknown / d known * seed */
enum Status directional_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                                   const unsigned *known, size_t known_count, const double *seed, double *value);

/*
 * value = seed^T * d unknown / d known: by a reverse sweep in FMUs that have it, at the same cost for any number of knowns;
 * in others by one directional derivative for each known.
 */
enum Status adjoint_derivative(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                               const unsigned *known, size_t known_count, const double *seed, double *value);

/* The first derivatives of outputs by time, with those of the inputs; prepared values are up to date. */
enum Status derivatives_in_time(struct Instance *instance, const unsigned *reference, size_t count, double *value);

/* The derivatives of outputs by time, each of its order. */
enum Status output_derivatives(struct Instance *instance, const unsigned *reference, size_t count, const int *order,
                               double *value);

#endif
