/*
 * Tensor-product Hermite interpolation. With the values f, the slopes f_x and f_y and the mixed derivatives f_xy at the
 * knots,
 *
 *   F(x, y) = sum over i, k of f V_i(x) V_k(y) + f_x S_i(x) V_k(y) + f_y V_i(x) S_k(y) + f_xy S_i(x) S_k(y).
 *
 * The cardinal functions V_i and S_i are piecewise cubic with zero values and slopes at all knots, except V_i = 1 and
 * S_i' = 1 at knot i. In bilinear surfaces S is 0 inside the grid and V is piecewise linear. Slopes are those of
 * curve.h along grid lines, so that F and its first derivatives are continuous in bicubic surfaces. The expression has
 * a size proportional to the number of values.
 *
 * C. de Boor, Bicubic spline interpolation, J. Math. and Phys. 41 (1962).
 */
#include "read/tables/surface.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/tables/piecewise.h"

/* Sets the slopes of `count` parallel grid lines with `length` knots each. The steps are distances in the arrays. */
static void slopes_of_lines(const double *knots, size_t length, size_t count, size_t step_in_line, size_t step_of_lines,
                            enum Interpolation interpolation, const double *values, double *slopes) {
  double *y = allocate(length, sizeof *y), *b = allocate(length, sizeof *b);
  struct Curve curve = {.x = (double *)knots, .y = y, .b = b, .count = length};
  for (size_t line = 0; line < count; line++) {
    for (size_t i = 0; i < length; i++) y[i] = values[line * step_of_lines + i * step_in_line];
    curve_slopes(&curve, interpolation);
    for (size_t i = 0; i < length; i++) slopes[line * step_of_lines + i * step_in_line] = b[i];
  }
}

/*
 * The mixed derivative is the mean of both orders of differentiation. They agree for linear methods, LINEAR and SPLINE,
 * but not for MONOTONE.
 */
void surface_interpolate(struct SurfaceTable *surface, enum Interpolation interpolation) {
  size_t columns = surface->columns, rows = surface->rows, count = columns * rows;
  double *other = allocate(count, sizeof *other);
  surface->interpolation = interpolation;
  surface->along_x = allocate(count, sizeof(double));
  surface->along_y = allocate(count, sizeof(double));
  surface->along_both = allocate(count, sizeof(double));
  slopes_of_lines(surface->x, columns, rows, 1, columns, interpolation, surface->value, surface->along_x);
  slopes_of_lines(surface->y, rows, columns, columns, 1, interpolation, surface->value, surface->along_y);
  slopes_of_lines(surface->y, rows, columns, columns, 1, interpolation, surface->along_x, surface->along_both);
  slopes_of_lines(surface->x, columns, rows, 1, columns, interpolation, surface->along_y, other);
  for (size_t i = 0; i < count; i++) surface->along_both[i] = (surface->along_both[i] + other[i]) / 2;
}

/* The cardinal functions V and S of each knot at a given argument. */
struct Cardinals {
  Node *value, *slope;
  size_t count;
};

/*
 * Adds an interval of width h to the cardinal functions of its two knots. t is the clamped coordinate, 0 before the
 * interval and 1 after it.
 */
static void add_interval(struct Graph *graph, struct Cardinals *cardinals, size_t i, Node t, double h, bool is_linear) {
  Node rest = subtract(graph, ONE, t), rise = t;
  if (!is_linear) {
    Node twice = scale(graph, 2, t), linear = subtract(graph, graph_constant(graph, 3), twice);
    Node square = power_number(graph, t, 2), square_of_rest = power_number(graph, rest, 2);
    rise = multiply(graph, square, linear);
    Node near = multiply(graph, scale(graph, h, t), square_of_rest);
    Node far = multiply(graph, scale(graph, -h, rest), square);
    cardinals->slope[i] = add(graph, cardinals->slope[i], near);
    cardinals->slope[i + 1] = add(graph, cardinals->slope[i + 1], far);
  }
  cardinals->value[i] = subtract(graph, cardinals->value[i], rise);
  cardinals->value[i + 1] = add(graph, cardinals->value[i + 1], rise);
}

static struct Cardinals cardinals_at(struct Scope *scope, const double *knots, size_t count, bool is_linear,
                                     bool is_constant_outside, Node x) {
  struct Graph *graph = scope->graph;
  struct Cardinals cardinals = {allocate(count, sizeof(Node)), allocate(count, sizeof(Node)), count};
  cardinals.value[0] = ONE;
  if (!is_constant_outside) {
    cardinals.slope[0] = offset_below(scope, x, knots[0]);
    cardinals.slope[count - 1] = offset_above(scope, x, knots[count - 1]);
  }
  for (size_t i = 0; i + 1 < count; i++) {
    double h = knots[i + 1] - knots[i];
    Node t = scale(graph, 1 / h, clamped_offset(scope, x, knots[i], knots[i + 1]));
    add_interval(graph, &cardinals, i, t, h, is_linear);
  }
  return cardinals;
}

/* Returns a column's contribution at y, given its values and their derivatives with respect to y. */
static Node column_at(struct Graph *graph, const struct Cardinals *along_y, const double *values, const double *slopes,
                      size_t step) {
  Node sum = ZERO;
  for (size_t row = 0; row < along_y->count; row++) {
    sum = add(graph, sum, scale(graph, values[row * step], along_y->value[row]));
    sum = add(graph, sum, scale(graph, slopes[row * step], along_y->slope[row]));
  }
  return sum;
}

Node surface_at(struct Scope *scope, const struct SurfaceTable *surface, bool is_constant_outside, Node x, Node y) {
  struct Graph *graph = scope->graph;
  bool is_linear = surface->interpolation == LINEAR;
  struct Cardinals along_x = cardinals_at(scope, surface->x, surface->columns, is_linear, is_constant_outside, x);
  struct Cardinals along_y = cardinals_at(scope, surface->y, surface->rows, is_linear, is_constant_outside, y);
  Node sum = ZERO;
  for (size_t i = 0; i < surface->columns; i++) {
    Node value = column_at(graph, &along_y, surface->value + i, surface->along_y + i, surface->columns);
    sum = add(graph, sum, multiply(graph, along_x.value[i], value));
    if (along_x.slope[i] == ZERO) continue;
    Node slope = column_at(graph, &along_y, surface->along_x + i, surface->along_both + i, surface->columns);
    sum = add(graph, sum, multiply(graph, along_x.slope[i], slope));
  }
  return sum;
}
