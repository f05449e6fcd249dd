/*
 * Piecewise cubic Hermite interpolation. On the interval i of width h[i] and secant slope D[i], the slopes b at its
 * ends give
 *
 *   c[i] = (3 D[i] - 2 b[i] - b[i+1]) / h[i],   d[i] = (b[i] + b[i+1] - 2 D[i]) / h[i]^2.
 *
 * The methods differ in their slopes at the points:
 *
 * LINEAR: b[i] = D[i], and c = d = 0.
 *
 * MONOTONE (PCHIP): b[i] is the weighted harmonic mean of D[i-1] and D[i], with weights 2 h[i] + h[i-1] and h[i] + 2
 * h[i-1], or 0 if their signs differ. At the ends a parabola through three points gives the slope, limited so that the
 * curve stays monotone.
 *
 * SPLINE: the second derivative is continuous,
 *
 *   h[i] b[i-1] + 2 (h[i-1] + h[i]) b[i] + h[i-1] b[i+1] = 3 (h[i] D[i-1] + h[i-1] D[i]),
 *
 * and with the not-a-knot condition the first two intervals share one cubic, as do the last two. Gaussian elimination
 * solves the tridiagonal system without pivoting, as all pivots are positive. The cost is linear in the number of
 * points.
 *
 * F. N. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat.
 * Comput. 5 (1984).
 * C. de Boor, A Practical Guide to Splines, revised edition, 2001, chapter IV.
 */
#include "read/tables/curve.h"

#include <math.h>

#include "base/memory.h"

static double width(const struct Curve *curve, size_t i) {
  return curve->x[i + 1] - curve->x[i];
}

static double secant(const struct Curve *curve, size_t i) {
  return (curve->y[i + 1] - curve->y[i]) / width(curve, i);
}

static void linear_slopes(struct Curve *curve) {
  for (size_t i = 0; i + 1 < curve->count; i++) curve->b[i] = secant(curve, i);
  curve->b[curve->count - 1] = secant(curve, curve->count - 2);
}

/*
 * Returns the slope at an end from the widths and secant slopes of the two nearest intervals. A slope of the wrong sign
 * becomes 0, and one that would overshoot is limited to three times the secant slope.
 */
static double end_slope(double near, double far, double near_secant, double far_secant) {
  double slope = ((2 * near + far) * near_secant - near * far_secant) / (near + far);
  if (slope * near_secant <= 0) return 0;
  if (near_secant * far_secant <= 0 && fabs(slope) > 3 * fabs(near_secant)) return 3 * near_secant;
  return slope;
}

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

/* An equation for three neighbouring slopes: below b[i-1] + diagonal b[i] + above b[i+1] = right. */
struct SlopeEquation {
  double below, diagonal, above, right;
};

/* Returns the not-a-knot condition at an end, in the order from the end inwards. */
static struct SlopeEquation shared_cubic(double near, double far, double near_secant, double far_secant) {
  double both = near + far;
  return (struct SlopeEquation){.diagonal = far,
                                .above = both,
                                .right = ((near + 2 * both) * far * near_secant + near * near * far_secant) / both};
}

static struct SlopeEquation row_of(const struct Curve *curve, size_t i) {
  size_t last = curve->count - 1;
  if (curve->count == 3 && i == 0)
    return (struct SlopeEquation){0, 1, 1, 2 * secant(curve, 0)}; /* three points: one parabola */
  if (curve->count == 3 && i == 2) return (struct SlopeEquation){1, 1, 0, 2 * secant(curve, 1)};
  if (i == 0) return shared_cubic(width(curve, 0), width(curve, 1), secant(curve, 0), secant(curve, 1));
  if (i == last) {
    struct SlopeEquation row =
        shared_cubic(width(curve, last - 1), width(curve, last - 2), secant(curve, last - 1), secant(curve, last - 2));
    return (struct SlopeEquation){row.above, row.diagonal, 0, row.right};
  }
  double before = width(curve, i - 1), after = width(curve, i);
  return (struct SlopeEquation){after, 2 * (before + after), before,
                                3 * (after * secant(curve, i - 1) + before * secant(curve, i))};
}

static void spline_slopes(struct Curve *curve) {
  size_t n = curve->count;
  if (n == 2) {
    linear_slopes(curve);
    return;
  }
  struct SlopeEquation *rows = allocate(n, sizeof *rows);
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
