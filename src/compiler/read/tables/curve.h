/* Curves through points: cubic polynomials between neighbours, which are continuous with their first derivative. */
#pragma once

#include <stddef.h>

enum Interpolation {
  LINEAR,   /* straight lines, whose slopes jump at the points */
  MONOTONE, /* rises and falls where the points do: slopes of Fritsch and Butland, as in PCHIP */
  SPLINE    /* with a continuous second derivative; the first two intervals share one cubic, as do the last two */
};

/* y + s (b + s (c + s d)) with s = x - x[i] between the points i and i + 1; at the last point b is the slope. */
struct Curve {
  double *x, *y, *b, *c, *d;
  size_t count;
};

/* Fills b alone, which is there already. */
void curve_slopes(struct Curve *curve, enum Interpolation interpolation);

/* Fills b, c and d from x, which ascends strictly, and y of at least two points. */
void curve_interpolate(struct Curve *curve, enum Interpolation interpolation);
