/*
 * Surfaces through the values on a grid: between four neighbours products of cubic polynomials, which are continuous with
 * their first derivatives, or of straight lines. On each line of the grid they are the curves of curve.h.
 */
#pragma once

#include "read/names/scope.h"
#include "read/tables/curve.h"

/* The value at x[column] and y[row], and the derivatives there, are in row * columns + column. */
struct Surface {
  double *x, *y;
  size_t columns, rows;
  double *value, *along_x, *along_y, *along_both;
  enum Interpolation interpolation;
};

/* Fills the derivatives from x and y, which ascend strictly, and values; at least two of each. */
void surface_interpolate(struct Surface *surface, enum Interpolation interpolation);

/*
 * The value at x and y; outside it goes on with the slope of the border, or is constant. As a sum over the grid of values
 * times functions of x and of y, which are 1 at their own knot and 0 at the others.
 */
Node surface_at(struct Scope *scope, const struct Surface *surface, bool is_constant_outside, Node x, Node y);
