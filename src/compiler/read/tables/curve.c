#include "read/tables/curve.h"

#include <math.h>

#include "base/memory.h"

static double width(const struct Curve *curve, size_t i) {
  return curve->x[i + 1] - curve->x[i];
}

/* Of the straight line from the point i to the next. */
static double secant(const struct Curve *curve, size_t i) {
  return (curve->y[i + 1] - curve->y[i]) / width(curve, i);
}

static void linear_slopes(struct Curve *curve) {
  for (size_t i = 0; i + 1 < curve->count; i++) curve->b[i] = secant(curve, i);
  curve->b[curve->count - 1] = secant(curve, curve->count - 2);
}

/* The slope at an end of three points, by their parabola as far as that keeps the curve monotone. */
static double end_slope(double near, double far, double near_secant, double far_secant) {
  double slope = ((2 * near + far) * near_secant - near * far_secant) / (near + far);
  if (slope * near_secant <= 0) return 0;
  if (near_secant * far_secant <= 0 && fabs(slope) > 3 * fabs(near_secant)) return 3 * near_secant;
  return slope;
}

/* F. N. Fritsch, J. Butland: A method for constructing local monotone piecewise cubic interpolants, 1984. */
static void monotone_slopes(struct Curve *curve) {
  size_t last = curve->count - 1;
  if (last == 1) {
    linear_slopes(curve);
    return;
  }
  for (size_t i = 1; i < last; i++) {
    double before = width(curve, i - 1), after = width(curve, i);
    double left = secant(curve, i - 1), right = secant(curve, i);
    double near_left = 2 * after + before, near_right = after + 2 * before;
    curve->b[i] = left * right > 0 ? (near_left + near_right) / (near_left / left + near_right / right) : 0;
  }
  curve->b[0] = end_slope(width(curve, 0), width(curve, 1), secant(curve, 0), secant(curve, 1));
  curve->b[last] =
      end_slope(width(curve, last - 1), width(curve, last - 2), secant(curve, last - 1), secant(curve, last - 2));
}

/* One equation for the slopes at three neighbouring points: below b_(i-1) + diagonal b_i + above b_(i+1) = right. */
struct Row {
  double below, diagonal, above, right;
};

/* The first and the last row where two intervals share one cubic, from the end inwards. */
static struct Row shared_cubic(double near, double far, double near_secant, double far_secant) {
  double both = near + far;
  return (struct Row){.diagonal = far,
                      .above = both,
                      .right = ((near + 2 * both) * far * near_secant + near * near * far_secant) / both};
}

static struct Row row_of(const struct Curve *curve, size_t i) {
  size_t last = curve->count - 1;
  if (curve->count == 3 && i == 0) return (struct Row){0, 1, 1, 2 * secant(curve, 0)}; /* a parabola */
  if (curve->count == 3 && i == 2) return (struct Row){1, 1, 0, 2 * secant(curve, 1)};
  if (i == 0) return shared_cubic(width(curve, 0), width(curve, 1), secant(curve, 0), secant(curve, 1));
  if (i == last) {
    struct Row row =
        shared_cubic(width(curve, last - 1), width(curve, last - 2), secant(curve, last - 1), secant(curve, last - 2));
    return (struct Row){row.above, row.diagonal, 0, row.right};
  }
  double before = width(curve, i - 1), after = width(curve, i);
  return (struct Row){after, 2 * (before + after), before,
                      3 * (after * secant(curve, i - 1) + before * secant(curve, i))};
}

static void spline_slopes(struct Curve *curve) {
  size_t n = curve->count;
  if (n == 2) {
    linear_slopes(curve);
    return;
  }
  struct Row *rows = allocate(n, sizeof *rows);
  for (size_t i = 0; i < n; i++) rows[i] = row_of(curve, i);
  for (size_t i = 1; i < n; i++) {
    double factor = rows[i].below / rows[i - 1].diagonal;
    rows[i].diagonal -= factor * rows[i - 1].above;
    rows[i].right -= factor * rows[i - 1].right;
  }
  for (size_t i = n; i-- > 0;)
    curve->b[i] = (rows[i].right - (i + 1 < n ? rows[i].above * curve->b[i + 1] : 0)) / rows[i].diagonal;
}

void curve_slopes(struct Curve *curve, enum Interpolation interpolation) {
  static void (*const slopes[])(struct Curve *) = {
      [LINEAR] = linear_slopes, [MONOTONE] = monotone_slopes, [SPLINE] = spline_slopes};
  slopes[interpolation](curve);
}

void curve_interpolate(struct Curve *curve, enum Interpolation interpolation) {
  curve->b = allocate(curve->count, sizeof *curve->b);
  curve->c = allocate(curve->count, sizeof *curve->c);
  curve->d = allocate(curve->count, sizeof *curve->d);
  curve_slopes(curve, interpolation);
  for (size_t i = 0; i + 1 < curve->count && interpolation != LINEAR; i++) {
    double h = width(curve, i), line = secant(curve, i), left = curve->b[i], right = curve->b[i + 1];
    curve->c[i] = (3 * line - 2 * left - right) / h;
    curve->d[i] = (left + right - 2 * line) / (h * h);
  }
}
