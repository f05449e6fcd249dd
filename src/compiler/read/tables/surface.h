/*
 * Interpolation of values on a rectangular grid by piecewise bilinear or bicubic polynomials. On each grid line the
 * surface is the curve of curve.h. See surface.c for the method.
 */
#pragma once

#include "names/scope.h"
#include "read/tables/curve.h"

/* The value at x[column] and y[row], and the derivatives there, have the index row * columns + column. */
struct SurfaceTable {
  double *x, *y;
  size_t columns, rows;
  double *value, *along_x, *along_y, *along_both;
  enum Interpolation interpolation;
};

/* Allocates and sets the derivatives. x and y ascend strictly; there are at least two of each. */
void surface_interpolate(struct SurfaceTable *surface, enum Interpolation interpolation);

/* Returns the surface at x and y as an expression; beyond the border with the slope there, or constant. */
Node surface_at(struct Scope *scope, const struct SurfaceTable *surface, bool is_constant_outside, Node x, Node y);
