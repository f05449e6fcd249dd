/*
 * Pairs (a, b) in the second-order cone a >= |b|, where b has one or two elements. The product of its Jordan algebra is
 * (a, b) o (c, d) = (a c + b d, a d + c b), and its unit e = (1, 0). Vectors have `size` elements, 2 or 3.
 */
#pragma once

#include <stddef.h>

/* Most elements of a pair. */
enum { CONE_SIZE = 3 };

/* The scaling Q = factor (2 v v^T - R), R = diag(1, -1, -1), where v has a determinant v_0^2 - v_1^2 - v_2^2 of 1. */
struct Scaling {
  double v[CONE_SIZE], factor;
};

/* Returns |b|. */
double length_of_tail(const double *pair, size_t size);

/*
 * Returns the scaling with Q s = y of two pairs inside of the cone (Y. E. Nesterov and M. J. Todd: Self-scaled barriers,
 * Mathematics of Operations Research 22, 1997).
 */
struct Scaling scaling_of(const double *s, const double *y, size_t size);

double scaling_element(const struct Scaling *scaling, size_t i, size_t j);

/* Fills Q vector. */
void scale_pair(const struct Scaling *scaling, size_t size, const double *vector, double *scaled);

/*
 * Fills t with which the step y + dy = t - Q ds leads to s o y = mu e, with the terms of second order of a predicted step
 * ds, dy. For a step of 0 it is mu / s.
 */
void fill_target(const struct Scaling *scaling, size_t size, const double *s, const double *ds, const double *dy,
                 double mu, double *target);

/* Returns the largest step that keeps a pair in the cone; INFINITY without a bound. */
double longest_step_in_cone(const double *pair, const double *change, size_t size);
