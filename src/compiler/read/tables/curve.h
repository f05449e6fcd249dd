/* Interpolation of points by piecewise polynomials, linear or cubic. See curve.c for the methods. */
#pragma once

#include <stddef.h>

enum Interpolation {
  LINEAR,   /* straight lines, whose slope jumps at the points */
  MONOTONE, /* monotone between the points where these are: PCHIP */
  SPLINE    /* cubic spline with not-a-knot ends: continuous second derivative */
};

/*
 * y = y[i] + s (b[i] + s (c[i] + s d[i])) with s = x - x[i] between the points i and i + 1. At the last point b is the
 * slope.
 */
struct Curve {
  double *x, *y, *b, *c, *d;
  size_t count;
};

/* Sets the slopes b, which the caller has allocated. */
void curve_slopes(struct Curve *curve, enum Interpolation interpolation);

/* Allocates and sets b, c and d. x ascends strictly; there are at least two points. */
void curve_interpolate(struct Curve *curve, enum Interpolation interpolation);
